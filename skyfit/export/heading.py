"""What stands at the top of an exported sky: where it is from, how good it is, how to use it."""

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..fitting import SkyFit
from ..models.formula import FormulaSky
from ..models.perez import Perez
from ..models.preetham import published_coefficients
from ..provenance import package_version
from .description import Description


def heading(description: Description, prefix: str, provenance: list[str]) -> list[str]:
    """Lines without marks of comment, of text that no language takes for anything else."""
    swept = "".join(f", {name}" for name in description.swept)
    lines = [
        "Luminance and colour of a clear sky in any direction.",
        "",
        *provenance,
        "",
        *description.formula.split("\n"),
        "",
        f"Use {prefix}_xyz, {prefix}_xyY or {prefix}_rgb (direction, sun_direction{swept}).",
        "Directions are unit vectors with z up, from the eye; the sun's disc is not in the sky.",
        "Angles are in radians, luminances in cd/m^2.",
        "",
        *description.policy.split("\n"),
    ]
    return list(map(_harmless, lines))


def provenance_of_fit(fit: SkyFit) -> list[str]:
    """What a fit was made from, how well it follows that, and where it holds."""
    data, made_by = _table(fit.provenance.get("data")), _table(fit.provenance.get("versions"))
    errors = ", ".join(f"{name} {100 * d.rms:.2g} %" for name, d in fit.diagnostics.items())
    scale = ", ".join(f"{name} {100 * rms:.2g} %" for name, rms in fit.notes.scale_rms.items())
    what = "zenith" if fit.distribution.relative else "scale"
    positive = [fit.positivity] if fit.positivity else []
    lines = [
        f"Fitted by skyfit {made_by.get('skyfit', 'of unknown version')}.",
        *(f"Skies: {line}" for line in _skies(data)),
        f"RMS error of the fit, relative: {errors}.",
        f"RMS error of the {what}, relative: {scale}.",
        *(f"Over the valid range: {margin.sentence()}." for margin in positive),
        *valid_range(fit.swept, fit.sun_zenith_range),
    ]
    return list(map(_ascii, lines))


def provenance_of_model(sky: FormulaSky) -> list[str]:
    """The same for a model that was not fitted here."""
    coefficients = published_coefficients()
    published = (
        sky.distribution.name == Perez.name
        and not sky.linked
        and sky.numbers.shape == coefficients.shape
        and np.allclose(sky.numbers, coefficients, rtol=1e-6)
    )
    paper = "Preetham, Shirley & Smits (1999), A Practical Analytic Model for Daylight"
    return [
        f"Written by skyfit {package_version('skyfit')}.",
        f"Source: {paper}, appendix A.2." if published else "Source: a sky model of the caller's.",
        *valid_range(dict(sky.ranges), sky.sun_zenith_range),
    ]


def valid_range(swept: Mapping[str, tuple[float, float]], suns: tuple[float, float]) -> list[str]:
    """Where the formula holds, in words."""
    low, high = (math.degrees(sun) for sun in suns)
    ends = "".join(f"{name} {a:.6g} to {b:.6g}, " for name, (a, b) in swept.items())
    return [f"Valid range: {ends}sun {low:.4g} to {high:.4g} degrees from the zenith."]


def _skies(data: dict[str, Any]) -> list[str]:
    """The skies a fit was made from, as far as its record tells."""
    lines = [str(data.get("title", "not described"))]
    campaign = _table(_parsed(data.get("campaign")))
    if campaign:
        orders = campaign.get("orders")
        light = "all orders" if orders is None else f"{orders} orders of scattering"
        lines.append(f"{light}, geometry {campaign.get('geometry')}")
        atmosphere = campaign.get("atmosphere")
        if isinstance(atmosphere, dict):
            lines += [f"{key.replace('_', ' ')}: {value}" for key, value in atmosphere.items()]
    atmospheres = _parsed(data.get("atmosphere"))
    if isinstance(atmospheres, list) and atmospheres:
        parts = _table(atmospheres[0]).get("constituents", [])
        lines += [
            f"constituent: {_kind(part, 'density')} density, {_kind(part, 'phase')} phase function"
            for part in (map(_table, parts) if isinstance(parts, list) else ())
        ]
    return lines


def _ascii(line: str) -> str:
    """One line of printable ASCII: some compilers of shaders refuse anything else in comments."""
    text = line.replace("°", " deg").encode("ascii", "replace").decode()
    return "".join(letter if letter.isprintable() else " " for letter in text)


# What ends, opens or continues a comment or a docstring somewhere: the last two in C and in HTML.
_MARKS = {"\\": "/", '"': "'", "*/": "* /", "/*": "/ *", "??": "? ?", "</": "< /"}


def _harmless(line: str) -> str:
    """A line that stays inside any comment or docstring, whatever file its words are from."""
    text = _ascii(line)
    for mark, instead in _MARKS.items():
        while mark in text:
            text = text.replace(mark, instead)
    return text


def _kind(part: dict[str, Any], key: str) -> str:
    return str(_table(part.get(key)).get("type", "unnamed"))


def _table(found: Any) -> dict[str, Any]:
    """What a record holds under a name, where that is a table as it should be."""
    return found if isinstance(found, dict) else {}


def _parsed(text: Any) -> Any:
    try:
        return json.loads(text)
    except (TypeError, ValueError, RecursionError):
        return None
