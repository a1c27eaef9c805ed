"""Pictures of aerial perspective: how exact its integrals are, and what it does at sunset."""

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..aerial import closed, integrals, layers, sunset_airlight
from ..preetham_air import preetham_atmosphere
from . import style


TURBIDITY = 3.0
_CONVERGED = 300  # nodes; agrees with dense panels to 1e-9 (tests/test_aerial_paths.py)
_SCALE = LogNorm(1e-8, 1.0)
_METHODS = {
    "quadrature (default)": integrals.by_quadrature,
    "equation 10": closed.near_level,
    "Hermite cubic, slopes by v": lambda air, ray: closed.by_hermite(air, ray, "by v"),
    "paper: eq. 10, or cubic with slopes by x": closed.as_published,
}


def path_errors(
    view_zenith_deg: np.ndarray, distance: np.ndarray, observer_altitude: float = 0.0
) -> dict[str, np.ndarray]:
    """Relative error of the light scattered in, at 550 nm and turbidity 3, by method.

    Both constituents shine in proportion to their extinction.

    Args:
        view_zenith_deg: View zenith angles, one axis [degrees].
        distance: Distances, one axis [m].
        observer_altitude: Altitude of the eye [m].

    Returns:
        For each method [view, distance].
    """
    extinction = preetham_atmosphere(TURBIDITY, wavelengths=[550.0]).extinction
    air = layers.Layers(jnp.asarray(layers.PAPER_SCALE_HEIGHTS), extinction)
    view, far = np.meshgrid(np.radians(view_zenith_deg), distance, indexing="ij")
    ray = layers.stretch(
        air, jnp.asarray(far), jnp.cos(view), jnp.full(far.shape, observer_altitude)
    )

    def light(method):
        return np.asarray(jnp.tensordot(extinction[:, 0], jax.jit(method)(air, ray), axes=1))[
            ..., 0
        ]

    exact = light(lambda air, ray: integrals.by_quadrature(air, ray, _CONVERGED))
    return {name: np.abs(light(method) / exact - 1) for name, method in _METHODS.items()}


def path_error_chart() -> Figure:
    """Maps of `path_errors` over view zenith angle and distance, from an eye at the ground."""
    view, distance = np.linspace(0.0, 100.0, 201), np.geomspace(100.0, 1e6, 121)
    with style.house_style():
        figure = style.new_figure(8.2, 5.6)
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for axes, (name, error) in zip(
            panels.flat, path_errors(view, distance).items(), strict=True
        ):
            axes.pcolormesh(
                distance / 1e3, view, np.maximum(error, 1e-8), cmap=style.LUMINANCE_MAP,
                norm=_SCALE, shading="nearest", rasterized=True,
            )  # fmt: skip
            worst = error.max()
            text = f"to {worst:.1g}" if worst < 10 else f"to 1e{np.log10(worst):.0f}"
            axes.set_title(f"{name}: {text}")
            axes.set_xscale("log")
            axes.axhline(90, color="white", lw=0.7, ls=":")
        for axes in panels[1]:
            axes.set_xlabel("distance [km]")
        for axes in panels[:, 0]:
            axes.set_ylabel("view zenith angle [°]")
        bar = figure.colorbar(
            ScalarMappable(_SCALE, style.LUMINANCE_MAP), ax=panels, extend="both", pad=0.02
        )
        bar.set_label("relative error of the light scattered in (550 nm, T = 3, eye at the ground)")
    return figure


def sunset_chart() -> Figure:
    """Colour of the air to the east and to the west at sunset, and by Ward-Larson's model."""
    distance = np.geomspace(500.0, 1e5, 60)
    sunset = sunset_airlight(distance)
    looks = {
        "east (away from the sun)": (sunset.east, style.REFIT),
        "west (towards it)": (sunset.west, style.PUBLISHED),
        "Ward-Larson, any direction": (sunset.constant, style.MEASURED | {"markevery": 6}),
    }
    with style.house_style():
        figure = style.new_figure(8.2, 3.4)
        plane, bright = figure.subplots(1, 2)
        for label, (light, look) in looks.items():
            x, y, luminance = np.asarray(light.xyY).T
            plane.plot(x, y, label=label, **look)
            bright.plot(distance / 1e3, luminance / 1e3, label=label, **look)
            for far in (1e3, 1e4):
                near = np.argmin(np.abs(distance - far))
                above = (-26, 4) if light is sunset.west else (5, -9)
                plane.annotate(f"{far / 1e3:.0f} km", (x[near], y[near]), fontsize=7,
                               textcoords="offset points", xytext=above)  # fmt: skip
        plane.plot(0.3127, 0.3290, "k+", label="D65 white")
        plane.set_xlabel("chromaticity x")
        plane.set_ylabel("chromaticity y")
        plane.legend(loc="lower right")
        bright.set_xscale("log")
        bright.xaxis.set_major_formatter("{x:g}")
        bright.set_xlabel("distance of a black object [km]")
        bright.set_ylabel("luminance of the air before it [kcd/m²]")
        figure.suptitle(
            "Level view half an hour before sunset, sun 5° high, turbidity 6", fontsize=9
        )
    return figure
