"""The paper's pipeline from end to end: `reproduce`."""

import json
import os
from dataclasses import asdict
from datetime import UTC, datetime
from os import PathLike
from typing import Any

import numpy as np
import xarray as xr

from .._progress import Progress, silent
from ..campaign import Campaign, PaperAtmosphere
from ..colour import PAPER_CHANNELS
from ..dataset import save_dataset
from ..dataset.runner import run_campaign
from ..errors import InputError
from ..fitting import SkyFit
from ..fitting.channels import read_channels
from ..fitting.fit import fit_formula
from ..fitting.scales import early_night
from ..judging import recovery_error, shape_error
from ..models import preetham_sky
from ..plots import style
from ..plots.skies import modelled
from ..provenance import processor, versions
from .claims import judge
from .clock import Clock
from .coefficients import coefficient_table, within_errors, zenith_record
from .directory import SCHEMA, claim_directory
from .page import write_page
from .pictures import draw_pictures
from .reality import TURBIDITY, compare_with_cornell, simulate_cornell
from .sentences import notes
from .simplifications import simplifications
from .tristimulus import tristimulus_comparison


def reproduce(
    out: str | PathLike[str] = "skyfit-report",
    progress: Progress | None = None,
    *,
    campaign: Campaign | None = None,
    workers: int = 1,
) -> dict[str, Any]:
    """Simulate, fit, compare and report, as Preetham et al. (1999) went about it.

    Writes into `out`: report.html (needs nothing else), report.json, figures/, the simulated skies
    sky.nc and the fit fit.json.

    Args:
        out: Directory; made if absent, renewed if it holds a report.
        progress: Called as `progress(stage, done, total)`.
        campaign: The paper's by default. Its directions must be a half dome with the zenith, its
            turbidities two or more.
        workers: Threads that simulate side by side.

    Returns:
        What report.json holds.

    Raises:
        InputError: `out` holds something else; the campaign is not of the paper's atmosphere, or
            cannot be fitted.
    """
    plan = Campaign() if campaign is None else campaign
    if not isinstance(plan.atmosphere, PaperAtmosphere):
        raise InputError("reproduce(campaign=...): expected one of the paper's atmosphere")
    directory = claim_directory(out)
    tell = progress or silent
    clock = Clock()
    with clock.stage("fit"):
        tell("recovery check", 0, 1)
        recovery = recovery_error()
        tell("recovery check", 1, 1)
    with clock.stage("simulate"):
        dataset = run_campaign(plan, tell, workers=workers)
    with clock.stage("fit"):
        tell("fitting", 0, 2)
        fit = fit_formula(read_channels(dataset, "Yxy"), provenance=dataset.attrs)
        tell("fitting", 1, 2)
        tristimulus = tristimulus_comparison(dataset, fit)
        shapes = _shape_errors(dataset, fit)
        tell("fitting", 2, 2)
    with clock.stage("measured skies"):
        tell("measured skies", 0, 1)
        models = {"published": preetham_sky(TURBIDITY), "refit": _nearest(fit, TURBIDITY)}
        reality = compare_with_cornell(models, simulate_cornell(plan, workers))
        tell("measured skies", 1, 1)
    with clock.stage("simplifications"):
        tell("simplifications", 0, 1)
        shortcuts = simplifications(plan)
        tell("simplifications", 1, 1)
    with clock.stage("report"):
        save_dataset(dataset, directory / "sky.nc", overwrite=True)
        fit.save(directory / "fit.json")
        with style.house_style():
            pictures = draw_pictures(
                directory / "figures",
                dataset,
                fit,
                reality,
                tell,
            )
        record = {
            "schema": SCHEMA,
            "complete": True,
            "coefficients": coefficient_table(fit),
            "zenith": zenith_record(fit),
            "shape_error": shapes,
            "recovery_error": recovery,
            "tristimulus": tristimulus,
            "published_within_two_errors": within_errors(coefficient_table(fit)),
            **_zenith_differences(dataset),
            "cornell": reality.record(),
            "simplifications": shortcuts,
            "fit": _fit_record(fit),
            "campaign": plan.to_dict(),
            "versions": versions(),
            "made": {
                "date": datetime.now(UTC).date().isoformat(),
                "processor": processor(),
                "cores": os.cpu_count(),
                "precision": str(dataset["radiance"].dtype),
                "workers": workers,
            },
        }
    record["seconds"] = clock.seconds | {"total": sum(clock.seconds.values())}
    record["claims"] = [asdict(claim) for claim in judge(record)]
    (directory / "report.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    write_page(directory / "report.html", record, pictures, notes(record))
    return record


def _shape_errors(dataset: xr.Dataset, fit: SkyFit) -> dict[str, dict[str, float]]:
    pairs = {
        "refit_vs_simulation": shape_error(fit, dataset),
        "published_vs_simulation": shape_error(preetham_sky, dataset),
        "refit_vs_published": shape_error(fit, preetham_sky),
    }
    return {
        channel: {name: errors[channel] for name, errors in pairs.items()}
        for channel in PAPER_CHANNELS
    }


def _nearest(fit: SkyFit, turbidity: float):
    """The refit at a turbidity, or at the nearest one that was simulated."""
    low, high = fit.parameter_range or (turbidity, turbidity)
    return fit.sky(turbidity=float(np.clip(turbidity, low, high)))


def _zenith_differences(dataset: xr.Dataset) -> dict[str, dict[str, float]]:
    """Published zenith against the simulated one, over all skies."""
    zenith = dataset.isel(direction=int(np.argmin(dataset["view_zenith"].values)))
    suns = dataset["sun_zenith"].values
    up = np.zeros_like(suns)
    published = np.stack(
        [modelled(preetham_sky(float(t)))(suns, up, up) for t in dataset["turbidity"].values]
    )
    ratio = published[..., 2] / zenith["luminance"].values
    return {
        "zenith_ratio": {
            "lowest": float(ratio.min()),
            "median": float(np.median(ratio)),
            "highest": float(ratio.max()),
        },
        "zenith_difference": {
            name: float(np.mean(published[..., k] - zenith[name].values))
            for k, name in enumerate(("x", "y"))
        },
    }


def _fit_record(fit: SkyFit) -> dict[str, Any]:
    """What a sceptic asks of the fit."""
    stages = fit.two_stage or {}
    return {
        "settings": fit.settings,
        "early_night": early_night(fit),
        "diagnostics": {name: asdict(found) for name, found in fit.diagnostics.items()},
        "two_stage_rms": {name: stage.rms for name, stage in stages.items()},
    }
