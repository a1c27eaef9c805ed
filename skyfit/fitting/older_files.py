"""Documents of older fit files in the form of today's."""

from typing import Any

from ..errors import InputError
from ..models.domes import DISTRIBUTIONS


def upgraded(document: dict[str, Any]) -> dict[str, Any]:
    """A document of schema 1 or 2 in the form of schema 3.

    Raises:
        ValueError: The document says that it holds a form that no version knew.
        KeyError: A key is missing.
    """
    form = document.get("form", "published")  # schema 1 had no other
    if form not in ("published", "formula"):
        raise InputError(f"form: expected 'published' or 'formula'; got {form!r}")
    name, ends = document["parameter_name"], document["parameter_range"]
    swept = {name: ends} if name else {}
    upgrade = _published if form == "published" else _formula
    formula, more = upgrade(document, swept)
    formula |= {"ranges": swept, "sun_zenith_range": document["sun_zenith_range"]}
    kept = ("standard_errors", "diagnostics", "settings", "provenance")
    return {
        **{key: document[key] for key in kept},
        "positivity": document.get("positivity"),  # schema 1 had none
        **more,
        "formula": formula,
    }


def _published(document, swept):
    """Coefficients by slope and intercept, and the paper's zenith."""
    zenith = document["zenith"]
    formula = {
        "kind": "Yxy",
        "channels": list(document["coefficients"]),
        "wavelengths": None,
        "distribution": DISTRIBUTIONS["perez"]().describe(),
        "basis": [_line(name, ends) for name, ends in swept.items()],
        "linked": False,
        "numbers": _without_slopes(document["coefficients"], swept),
        "scale": {"kind": "paper zenith", "quantity": next(iter(swept), ""), "numbers": zenith},
    }
    more = {
        "standard_errors": _without_slopes(document["standard_errors"], swept),
        "scale_errors": document["zenith_standard_errors"],
        "scale_rms": document["zenith_rms"],
        "two_stage": document["two_stage"],
    }
    return formula, more


def _without_slopes(tables, swept):
    """Intercepts alone where nothing was swept."""
    if swept:
        return tables
    return {name: [row[1:] for row in table] for name, table in tables.items()}


def _formula(document, swept):
    """Numbers of polynomials or nodes, and the logarithm of the scale."""
    old = document["formula"]
    scale = old["scale"]
    kind = old["kind"]
    formula = {
        "kind": kind,
        "channels": old["channels"],
        "wavelengths": old["wavelengths"],
        "distribution": old["shape"],
        "basis": _axes(old["dependence"], swept),
        "linked": True,
        "numbers": old["numbers"],
        "scale": {
            "kind": "logarithm",
            "basis": _axes(scale["dependence"], swept),
            "numbers": [scale["numbers"][name] for name in old["channels"]],
            "dimming": [scale["dimming"][name] for name in old["channels"]],
            "lowest_sun": document["sun_zenith_range"][1],
            "night": [name not in ("x", "y") for name in old["channels"]],
        },
    }
    return formula, {"scale_errors": {}, "scale_rms": document["scale_rms"], "two_stage": None}


def _axes(dependence, swept):
    name, sun = next(iter(swept), None), dependence["sun_zenith"]
    parameter = dependence["parameter"]
    if dependence["kind"] == "nodes":
        axes = [_tents(name, parameter), _tents("sun_zenith", sun)]
    elif dependence["kind"] == "polynomial":
        suns = _chebyshev("sun_zenith", sun, sun["function"])
        axes = [_chebyshev(name, parameter, "identity"), suns]
    else:
        raise InputError(
            f"formula: expected a dependence of kind 'polynomial' or 'nodes'; "
            f"got {dependence['kind']!r}"
        )
    return [axis for axis in axes if axis]


def _line(name, ends):
    return {"quantity": name, "kind": "line", "low": ends[0], "high": ends[1]}


def _tents(name, nodes):
    return {"quantity": name, "kind": "tents", "nodes": nodes} if len(nodes) > 1 else None


def _chebyshev(name, axis, function):
    if not axis["degree"]:
        return None
    return {
        "quantity": name,
        "kind": "chebyshev",
        "of": "identity" if function == "zenith angle" else function,
        "low": axis["low"],
        "high": axis["high"],
        "degree": axis["degree"],
    }
