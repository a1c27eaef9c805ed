"""What the report says in words, made from its numbers."""

from typing import Any

from ..colour import PAPER_CHANNELS
from .claims import RECOVERED, percent


def notes(record: dict[str, Any]) -> dict[str, Any]:
    """The sentences of report.html: `summary`, `findings`, `fit_notes`, `provenance`."""
    return {
        "summary": _summary(record),
        "findings": _findings(record),
        "fit_notes": _fit_notes(record["fit"]),
        "provenance": _provenance(record["campaign"], record["fit"]["settings"]),
    }


def _summary(record: dict[str, Any]) -> list[str]:
    shape, cornell = record["shape_error"]["Y"], record["cornell"]
    ratio, error = cornell["luminance_ratio"], cornell["rmse_mW_m-2_sr-1_nm-1"]
    zenith = record["zenith_ratio"]
    worst = max(record["recovery_error"].values())
    return [
        f"The method is sound: on skies made from the published model the fit returns the "
        f"published coefficients within {worst:.0e}."
        if worst <= RECOVERED
        else f"The fit misses coefficients it should return exactly, by up to {worst:.0e}.",
        f"The formula, fitted anew, is {percent(shape['refit_vs_simulation'])} RMS from the "
        f"simulated shape of the luminance; the published coefficients are "
        f"{percent(shape['published_vs_simulation'])} from it.",
        f"The published zenith is {zenith['median']:.2f} times as bright as the simulated one in "
        f"the median sky ({zenith['lowest']:.2f} to {zenith['highest']:.2f}).",
        f"On a measured day the published model is {ratio['published']:.2f} times too bright and "
        f"{error['published']:.0f} mW m⁻² sr⁻¹ nm⁻¹ off; the refit {ratio['refit']:.2f} times and "
        f"{error['refit']:.0f}, the simulation it was fitted to {ratio['simulated']:.2f} times and "
        f"{error['simulated']:.0f}. What separates the simulation from the measurement is "
        "not the formula's doing: atmosphere, ground and orders of scattering are the paper's, not "
        "that day's.",
    ]


def _findings(record: dict[str, Any]) -> dict[str, str]:
    """What each picture shows, by its name."""
    shape, within = record["shape_error"], record["published_within_two_errors"]
    zenith, colour = record["zenith_ratio"], record["zenith_difference"]
    ratio = record["cornell"]["luminance_ratio"]

    def errors(channel: str) -> str:
        refit, published = (
            percent(shape[channel][f"{name}_vs_simulation"]) for name in ("refit", "published")
        )
        return f"the refit {refit}, the published coefficients {published}"

    return {
        "coefficients": f"{within['within']} of {within['of']} published numbers lie within two "
        "standard errors of the refit's.",
        "luminance_sections": f"From the simulated shape of the luminance {errors('Y')} RMS.",
        "chromaticity_sections": f"From the simulated x {errors('x')} RMS; from y {errors('y')}.",
        "domes": f"The published zenith is {zenith['median']:.2f} times as bright as the simulated "
        "in the median sky; its exposure is the others'.",
        "error_maps": "Over all skies the refit's luminance is "
        f"{percent(record['fit']['diagnostics']['Y']['worst'])} off in its worst direction.",
        "zenith": f"Published over simulated luminance {zenith['lowest']:.2f} to "
        f"{zenith['highest']:.2f}; chromaticity {colour['x']:+.3f} in x and {colour['y']:+.3f} "
        "in y, bluer where both are negative.",
        "cornell": "Luminance over the measured: "
        + ", ".join(f"{name} {value:.2f}" for name, value in ratio.items())
        + ".",
    }


def _fit_notes(fit: dict[str, Any]) -> str:
    parts = []
    for channel in PAPER_CHANNELS:
        found = fit["diagnostics"][channel]
        parts.append(f"{channel}: condition number {found['condition']:.0f}")
        if found["unidentified"]:
            parts[-1] += f", not determined by the skies: {'; '.join(found['unidentified'])}"
    text = ". ".join(parts)
    if fit["two_stage_rms"]:
        rms = ", ".join(f"{name} {percent(value)}" for name, value in fit["two_stage_rms"].items())
        text += f". Fitted turbidity by turbidity with a line drawn through afterwards: {rms} RMS"
    if fit["early_night"]:
        text += f". As in the paper, the zenith ends early: {fit['early_night']}"
    return (
        f"{text}. Standard errors treat the misfit in each direction as independent, which it is "
        "not: true uncertainties are larger."
    )


def _provenance(campaign: dict[str, Any], settings: dict[str, Any]) -> str:
    orders = "all orders" if campaign["orders"] is None else f"{campaign['orders']} orders"
    return (
        f"{len(campaign['turbidity'])} turbidities × {len(campaign['sun_zenith'])} suns × "
        f"{len(campaign['view_zenith'])} directions × {len(campaign['wavelengths'])} wavelengths; "
        f"{orders} of scattering, "
        f"{campaign['geometry']} geometry, quality “{campaign['quality']}”; turbidity by "
        f"{campaign['atmosphere']['turbidity_means']}. The paper lists neither its suns nor its "
        "directions, and its haze profile is an earlier one of the same author. "
        f"Fit: {settings['residuals']} residuals, {settings['weights']} weights. "
        "Simulated skies are in sky.nc, the fit in fit.json."
    )
