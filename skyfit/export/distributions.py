"""Distributions over the dome as source code: one function each, and its links."""

import math

from ..models.distribution import AbstractDistribution
from ..models.domes import LEAST_ROOT, SOFT
from ..models.perez import LEAST_COSINE
from .description import Function, Line, number


LEAST = number(LEAST_COSINE)
_ANGLES = ("cos_view", "gamma")
_COSINE = Line("cos_gamma", "cos(gamma)")

_PEREZ = Function(
    "distribution",
    "F = (1 + A exp(B / cos theta)) (1 + C exp(D gamma) + E cos^2 gamma).\n"
    "At the horizon and below it the first factor has its limit, 1.",
    ("A", "B", "C", "D", "E", *_ANGLES),
    (
        _COSINE,
        Line("gradation", f"1 + A * exp(B / max(cos_view, {LEAST}))"),
        Line("indicatrix", "1 + C * exp(D * gamma) + E * cos_gamma * cos_gamma"),
    ),
    "gradation * indicatrix",
)
_CIE = Function(
    "distribution",
    "F = (1 + a exp(b / cos theta)) (1 + c (exp(d gamma) - exp(d pi / 2)) + e cos^2 gamma).\n"
    "At the horizon and below it the first factor has its limit, 1.",
    ("a", "b", "c", "d", "e", *_ANGLES),
    (
        _COSINE,
        Line("gradation", f"1 + a * exp(b / max(cos_view, {LEAST}))"),
        Line("glow", f"c * (exp(d * gamma) - exp({number(math.pi / 2)} * d))"),
    ),
    "gradation * (1 + glow + e * cos_gamma * cos_gamma)",
)
_CHI = Function(
    "chi",
    "(1 + cos^2 gamma) / (1 + g^2 - 2 g cos gamma)^(3/2)",
    ("g", "cos_gamma"),
    (Line("base", "1 + g * g - 2 * g * cos_gamma"),),
    "(1 + cos_gamma * cos_gamma) / (base * sqrt(base))",
)
_AIRMASS = Line("airmass", f"1 / (max(cos_view, 0) + {number(SOFT)})")
_HOSEK_WILKIE = Function(
    "distribution",
    "F = (1 + A exp(B / (cos theta + 0.01)))\n"
    "    (C + D exp(E gamma) + F cos^2 gamma + G chi(H, gamma) + I sqrt(cos theta));\n"
    "below the horizon cos theta is held.",
    (*"ABCDEFGHI", *_ANGLES),
    (
        _COSINE,
        _AIRMASS,
        Line("gradation", "1 + A * exp(B * airmass)"),
        Line("glow", "D * exp(E * gamma) + F * cos_gamma * cos_gamma + G * chi(H, cos_gamma)"),
        Line("skylight", f"I * sqrt(max(cos_view, {number(LEAST_ROOT)}))"),
    ),
    "gradation * (C + glow + skylight)",
)


def distribution(formula: AbstractDistribution) -> tuple[Function, ...]:
    """The functions of a distribution; the last, `distribution`, takes its coefficients first."""
    if formula.name == "series":
        return (_CHI, _series(formula))
    return {"perez": (_PEREZ,), "cie": (_CIE,), "hosek-wilkie": (_CHI, _HOSEK_WILKIE)}[formula.name]


def linked(free: str, link: str) -> str:
    """Expression of a coefficient by its free number."""
    if link == "-exp":
        return f"-exp({free})"
    return f"1 / (1 + exp(-({free})))" if link == "logistic" else free


def _series(formula: AbstractDistribution) -> Function:
    fixed = formula.fixed()
    glows = [_power(p) for p in fixed["powers"]]
    glows += [f"exp({number(-k)} * gamma)" for k in fixed["decays"]]
    glows += [f"chi({number(g)}, cos_gamma)" for g in fixed["asymmetries"]]
    lines = [_COSINE, _AIRMASS]
    lines += [Line(f"h{j}", glow) for j, glow in enumerate(glows)]
    names = iter(formula.names)
    parts = []
    for i, thickness in enumerate((None, *fixed["thicknesses"])):
        total = " + ".join(f"{next(names)} * h{j}" for j in range(len(glows)))
        lines.append(Line(f"part{i}", total))
        left = "" if thickness is None else f"exp({number(-thickness)} * airmass) * "
        parts.append(f"{left}part{i}")
    return Function(
        "distribution",
        "F = sum of w_ij g_i(theta) h_j(gamma), g_i the light left over slant paths.",
        (*formula.names, *_ANGLES),
        tuple(lines),
        " + ".join(parts),
    )


def _power(exponent: int) -> str:
    return " * ".join(["cos_gamma"] * exponent) if exponent else "1"
