"""The paper's claims, each with what was found here. Verdicts follow from the numbers alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..colour import PAPER_CHANNELS


RECOVERED = 1e-9  # a fit that ends in rounding errors gives back what it was made from
# The paper says "well" and "badly" without numbers; these bounds are this report's.
WELL, ROUGHLY = 0.02, 0.15
SAME_ZENITH, SAME_COLOUR = 0.1, 0.005
AS_GOOD = 1.5  # times the misfit of the best fit
TWICE = 2.0
REALISTIC = 1.25  # times as bright as the measured sky, or as dark
GRADED = f"holds up to {100 * WELL:g} %, roughly up to {100 * ROUGHLY:g} %"
PAPER_HOURS = 600  # of one processor in 1999, section 3.2


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes:
        id: Short name.
        claim: Sentence that is judged.
        verdict: "holds", "holds roughly", "does not hold" or "for the record".
        figure: Numbers behind the verdict.
        rule: Bounds that the verdict was made by.
        section: Section of Preetham et al. (1999) that makes the claim, or follows from it.
    """

    id: str
    claim: str
    verdict: str
    figure: str
    rule: str
    section: str


def judge(record: dict[str, Any]) -> list[Claim]:
    """Set every claim beside the numbers of a report, before its own `claims` are in."""
    return [
        _recovery(record["recovery_error"]),
        _luminance_form(record["shape_error"]),
        _chromaticity_form(record["shape_error"]),
        _tristimulus(record["tristimulus"]),
        _published_shape(record["shape_error"], record["published_within_two_errors"]),
        _zenith_luminance(record["zenith_ratio"]),
        _zenith_colour(record["zenith_difference"]),
        _real_sky(record["cornell"]),
        _higher_orders(record["simplifications"]),
        _ground_light(record["simplifications"]),
        _flat_earth(record["simplifications"]),
        _effort(record["seconds"], record["campaign"]),
    ]


def percent(share: float) -> str:
    """A share as per cent, with two digits."""
    return f"{100 * share:.2g} %" if abs(share) < 0.1 else f"{100 * share:.0f} %"


def _recovery(errors: dict[str, float]) -> Claim:
    worst = max(errors.values())
    return Claim(
        "recovery",
        "Fitted to skies of the published model, the fit gives the published coefficients back",
        "holds" if worst <= RECOVERED else "does not hold",
        "largest error " + ", ".join(f"{name} {errors[name]:.1e}" for name in PAPER_CHANNELS),
        rule=f"holds up to {RECOVERED:g}, the size of rounding errors",
        section="A.2",
    )


def _graded(error: float) -> str:
    if error <= WELL:
        return "holds"
    return "holds roughly" if error <= ROUGHLY else "does not hold"


def _luminance_form(errors: dict[str, dict[str, float]]) -> Claim:
    error = errors["Y"]["refit_vs_simulation"]
    return Claim(
        "luminance_form",
        "Five coefficients, linear in turbidity and the same for every sun, describe the luminance",
        _graded(error),
        f"best fit {percent(error)} RMS from the simulation",
        rule=GRADED,
        section="3.2",
    )


def _chromaticity_form(errors: dict[str, dict[str, float]]) -> Claim:
    x, y = (errors[name]["refit_vs_simulation"] for name in ("x", "y"))
    return Claim(
        "chromaticity_form",
        "The same form describes the chromaticities x and y well",
        _graded(max(x, y)),
        f"best fit {percent(x)} (x) and {percent(y)} (y) RMS from the simulation",
        rule=GRADED,
        section="3.2",
    )


def _tristimulus(comparison: dict[str, dict[str, float]]) -> Claim:
    errors, colour = comparison["shape_error"], comparison["chromaticity_rms"]
    detour, direct = colour["from X, Y, Z"], colour["from x, y"]
    return Claim(
        "tristimulus",
        "It describes the tristimulus values X and Z badly, which is why x and y are fitted",
        "holds" if detour > TWICE * direct else "does not hold",
        f"best fits {percent(errors['X'])} (X), {percent(errors['Z'])} (Z) RMS; chromaticity off "
        f"by {detour:.4f} by way of X, Y, Z and by {direct:.4f} from x, y",
        rule=f"holds if chromaticity is off by more than {TWICE:g} times as much by way of X, Y, Z",
        section="3.2",
    )


def _published_shape(errors: dict[str, dict[str, float]], within: dict[str, int]) -> Claim:
    published = [errors[name]["published_vs_simulation"] for name in PAPER_CHANNELS]
    best = [errors[name]["refit_vs_simulation"] for name in PAPER_CHANNELS]
    agrees = all(p <= AS_GOOD * b for p, b in zip(published, best, strict=True))
    pairs = ", ".join(
        f"{name} {percent(p)} against {percent(b)}"
        for name, p, b in zip(PAPER_CHANNELS, published, best, strict=True)
    )
    return Claim(
        "published_coefficients",
        "The published coefficients are the best fit to the skies the paper describes, as rebuilt "
        "here",
        "holds" if agrees else "does not hold",
        f"RMS of the published against the best fit: {pairs}; {within['within']} of {within['of']} "
        "numbers within two standard errors",
        rule=f"holds if none is above {AS_GOOD:g} times the best fit",
        section="3.2, A.2",
    )


def _zenith_luminance(ratio: dict[str, float]) -> Claim:
    median = ratio["median"]
    return Claim(
        "zenith_luminance",
        "The published zenith luminance is that of the simulated skies",
        "holds" if abs(median - 1) <= SAME_ZENITH else "does not hold",
        f"published over simulated {ratio['lowest']:.2f} to {ratio['highest']:.2f}, median "
        f"{median:.2f}",
        rule=f"holds if the median is within {100 * SAME_ZENITH:g} % of 1",
        section="A.2",
    )


def _zenith_colour(difference: dict[str, float]) -> Claim:
    x, y = difference["x"], difference["y"]
    return Claim(
        "zenith_chromaticity",
        "The published zenith chromaticity is that of the simulated skies",
        "holds" if max(abs(x), abs(y)) <= SAME_COLOUR else "does not hold",
        f"published less simulated, mean: x {x:+.3f}, y {y:+.3f}",
        rule=f"holds if neither mean is above {SAME_COLOUR:g}",
        section="A.2",
    )


def _real_sky(cornell: dict[str, Any]) -> Claim:
    ratio, error = cornell["luminance_ratio"], cornell["rmse_mW_m-2_sr-1_nm-1"]
    close = abs(np.log(ratio["published"])) <= np.log(REALISTIC)
    return Claim(
        "measured_sky",
        f"The published model is realistic: a measured day of turbidity {cornell['turbidity']}",
        "holds" if close else "does not hold",
        "luminance over the measured and RMSE in mW m⁻² sr⁻¹ nm⁻¹: "
        + ", ".join(f"{name} {ratio[name]:.2f} and {error[name]:.0f}" for name in ratio),
        rule=f"holds if the published luminance is within a factor of {REALISTIC:g}",
        section="5",
    )


def _higher_orders(found: dict[str, Any]) -> Claim:
    low, high, where = _extremes(found, "higher_orders")
    return Claim(
        "higher_orders",
        "Third and higher orders of scattering are insignificant",
        _graded(high),
        f"they are {percent(low)} to {percent(high)} of the luminance, {where}",
        rule=GRADED,
        section="3.2",
    )


def _ground_light(found: dict[str, Any]) -> Claim:
    low, high, where = _extremes(found, "ground_light")
    return Claim(
        "ground_light",
        "Light from the ground may be left out",
        _graded(high),
        f"an albedo of {found['ground_albedo']} adds {percent(low)} to {percent(high)} to the "
        f"luminance of two orders, {where}",
        rule=GRADED,
        section="3.2",
    )


def _flat_earth(found: dict[str, Any]) -> Claim:
    low, high, where = _extremes(found, "flat")
    return Claim(
        "flat_earth",
        "Up to a view zenith of 70° the Earth may be taken as flat",
        _graded(high),
        f"largest error of the luminance {percent(low)} to {percent(high)}, {where}",
        rule=GRADED,
        section="3.2",
    )


def _extremes(found: dict[str, Any], name: str) -> tuple[float, float, str]:
    """Least and most of a table [turbidity][sun], and where the most is."""
    table = np.asarray(found[name])
    row, column = np.unravel_index(table.argmax(), table.shape)
    where = (
        f"most at turbidity {found['turbidity'][row]:g} with the sun "
        f"{found['sun_zenith_deg'][column]:g}° from the zenith"
    )
    return float(table.min()), float(table.max()), where


def _effort(seconds: dict[str, float], campaign: dict[str, Any]) -> Claim:
    skies = len(campaign["turbidity"]) * len(campaign["sun_zenith"])
    return Claim(
        "computing_time",
        f"Simulating the skies takes {PAPER_HOURS} hours of processor time",
        "for the record",
        f"{skies} skies in {seconds['simulate']:.0f} s, and {seconds['compile']:.0f} s of "
        "compiling in all",
        rule="not judged",
        section="3.2",
    )
