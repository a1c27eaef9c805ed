"""Make the pictures of the pages: python docs/make_pictures.py [NAME ...]."""

import sys
from pathlib import Path

import jax
import marched_pictures
import numpy as np
from matplotlib.figure import Figure

import skyfit
from skyfit import plots
from skyfit.models import cie_clear_sky, cie_overcast_sky
from skyfit.render import (
    AbstractSource,
    Fisheye,
    ModelSource,
    Panorama,
    Perspective,
    SimulatedSource,
    air_before,
    horizontal_irradiance,
    load_source,
    render,
    render_terrain,
    sample_elevation,
)


HERE = Path(__file__).parent
EYE = (16265.0, 4255.0)  # m: the highest hill of the sample but one
SIZE, SAMPLES = 560, 9


class EvenSky(AbstractSource):
    """One colour everywhere, with the light of another sky."""

    def __init__(self, source, sun_zenith):
        self.source, self.name = source, "even sky"
        self.light = horizontal_irradiance(source, sun_zenith, 0.0) / np.pi

    def xyz(self, direction, sun_zenith, sun_azimuth):
        """The same for all."""
        return np.broadcast_to(self.light, (len(direction), 3)).astype(np.float32)

    def sun_xyz(self, sun_zenith):
        """The other sky's."""
        return self.source.sun_xyz(sun_zenith)


def landscape(
    source, sun, looking, air="paper", sun_disc=True, eye=EYE, above=120.0, pitch=-5, shafts=False
):
    """The hills of the sample under a sun [degree]."""
    zenith, azimuth = np.radians(sun)
    camera = Perspective(
        SIZE, SIZE * 3 // 4, np.radians(looking), np.radians(pitch), np.radians(55), above
    )
    return render_terrain(
        source, sample_elevation(), camera, eye, zenith, azimuth,
        air_before(source, zenith, air, sunlight=sun_disc),
        samples=SAMPLES, sun_disc=sun_disc, shafts=shafts,
    )  # fmt: skip


def sheet(name, pictures, columns, evs=None):
    """Pictures with titles beside each other, as one file."""
    with plots.house_style():
        rows = -(-len(pictures) // columns)
        figure = Figure(figsize=(3.9 * columns, 3.15 * rows), layout="constrained")
        for number, (title, picture) in enumerate(pictures.items()):
            panel = figure.add_subplot(rows, columns, number + 1)
            pixels = picture.pixels(None if evs is None else evs[number])
            pixels = np.where(picture.inside[..., None], pixels, 255)  # white around a fisheye
            panel.imshow(pixels)
            panel.set_title(title)
            panel.set_axis_off()
        save(figure, name)


def save(figure, name):
    """As a PNG."""
    figure.savefig(HERE / f"{name}.png", dpi=100)


def landscapes():
    """The four conditions of the paper's figure 7."""
    two, six = load_source(None, 2.0), load_source(None, 6.0)
    overcast = ModelSource(cie_overcast_sky(), 10.0, "CIE overcast sky")
    pictures = {
        "morning, turbidity 2": landscape(two, (65, 100), 270),
        "evening, turbidity 2": landscape(two, (80, 285), 270),
        "evening, turbidity 6": landscape(six, (80, 285), 270),
        "overcast, turbidity 10": landscape(overcast, (50, 285), 270, sun_disc=False),
    }
    sheet("pictures_landscapes", pictures, 2)


def with_and_without():
    """The paper's figures 1 and 8."""
    sun, low = (65, 100), (83, 280)
    clear, hazy = load_source(None, 2.5), load_source(None, 6.0)
    larson = ModelSource(cie_clear_sky(6.0), 6.0, "CIE clear sky")
    pictures = {
        "even sky, no air": landscape(EvenSky(clear, np.radians(65)), sun, 300, "none"),
        "the paper's sky and air": landscape(clear, sun, 300),
        "CIE clear sky, Ward-Larson's air": landscape(larson, low, 90, "ward-larson"),
        "the paper's sky and air, turbidity 6": landscape(hazy, low, 90),
    }
    bright = [pictures[name].exposure() for name in pictures]
    sheet("pictures_aerial", pictures, 2, [bright[1], bright[1], bright[3], bright[3]])


def shafts():
    """Air in the shade of ridges."""
    valley, pictures = (19088.0, 7770.0), {}
    for turbidity, zenith, looking, above, pitch in (
        (4, 80, 275, 150.0, 8),
        (6, 78, 262, 20.0, 12),
    ):
        for cast, what in ((False, "the air all in the sun"), (True, "--shafts")):
            pictures[f"turbidity {turbidity}, {what}"] = landscape(
                load_source(None, float(turbidity)), (zenith, 250), looking,
                eye=valley, above=above, pitch=pitch, shafts=cast,
            )  # fmt: skip
    bright = [picture.exposure() for picture in pictures.values()]
    sheet("pictures_shafts", pictures, 2, [bright[0], bright[0], bright[2], bright[2]])


def orientation():
    """Where the compass and the sun lie in a panorama, and in those for four programs."""
    source, sun = load_source(None, 3.0), (np.radians(55), np.radians(140))
    # Facing, and which axes lie north, east, south and west.
    programs = {
        "--facing-deg 0": (0, ("", "", "", "")),
        "Blender: --facing-deg 90": (90, ("+Y", "+X", "−Y", "−X")),
        "three.js: --facing-deg 90": (90, ("−Z", "+X", "+Z", "−X")),
        "Mitsuba: --facing-deg 180": (180, ("−Z", "+X", "+Z", "−X")),
        "Unreal Engine: --facing-deg 270": (270, ("+X", "+Y", "−X", "−Y")),
    }
    with plots.house_style():
        figure = Figure(figsize=(7.6, 7.6), layout="constrained")
        grid = figure.add_gridspec(3, 2, height_ratios=(2.1, 1, 1))
        places = [grid[0, :], *(grid[row, column] for row in (1, 2) for column in (0, 1))]
        for place, (title, (facing, axes)) in zip(places, programs.items(), strict=True):
            picture = render(source, Panorama(256, np.radians(facing)), *sun)
            panel = figure.add_subplot(place)
            panel.imshow(picture.pixels(), extent=(-180, 180, -90, 90), aspect="equal")
            for number, name in enumerate(("north", "east", "south", "west")):
                turn = (90 * number - facing + 180) % 360 - 180
                panel.axvline(turn, color="w", linewidth=0.7)
                # At the seam the label goes to the left edge's inside.
                panel.text(
                    turn + 3 * (turn == -180), -14, f"{name} {axes[number]}".strip(),
                    ha="left" if turn == -180 else "center", va="center", color="k", fontsize=7,
                    bbox={"facecolor": "w", "alpha": 0.7, "linewidth": 0, "pad": 1.5},
                )  # fmt: skip
            turn = (140 - facing + 180) % 360 - 180
            panel.plot(turn, 35, "o", markersize=11, markerfacecolor="none", color="k")
            panel.set_title(title)
            panel.set_xticks(range(-180, 181, 90))
            panel.set_yticks(range(-90, 91, 45))
            panel.grid(visible=False)
            if facing == 0:
                panel.set_xlabel("azimuth from the middle [°]")
                panel.set_ylabel("elevation [°]")
                panel.annotate(
                    "sun: zenith angle 55°, azimuth 140°", (turn, 35), (5, 66), fontsize=8,
                    arrowprops={"arrowstyle": "-", "lw": 0.7},
                )  # fmt: skip
        save(figure, "pictures_orientation")


def domes():
    """One sky, published, simulated and measured."""
    measured = load_source(Path("cornell"), sun_zenith=np.radians(48.938))
    sun, azimuth = measured.sun_zenith, np.pi
    air = SimulatedSource(skyfit.preetham_atmosphere(2.53), "simulated")
    pictures = {
        "published model": render(load_source(None, 2.53), Fisheye(320), sun, azimuth),
        "simulated, two orders": render(air, Fisheye(320), sun, azimuth),
        "measured (Kider et al. 2014)": render(
            measured, Fisheye(320), sun, azimuth, sun_disc=False
        ),
    }
    shared = pictures["measured (Kider et al. 2014)"].exposure()
    sheet("pictures_domes", pictures, 3, [shared] * 3)


def front():
    """One measured day: the sky itself, this day's air, a formula fitted to it, the published."""
    measured = load_source(Path("cornell"), sun_zenith=np.radians(48.938))
    sun, azimuth = measured.sun_zenith, np.pi
    sims = HERE.parent / "sims"
    skies = {
        "measured: Ithaca, 27 May 2013": measured,
        "simulated: that day's air, all orders": load_source(sims / "cornell_2013.toml"),
        "formula fitted to the simulation": load_source(sims / "cornell_2013.fit.json", 2.53),
        "published in 1999, as shipped everywhere": load_source(None, 2.53),
    }
    pictures = {
        title: render(sky, Fisheye(360), sun, azimuth, sun_disc=False)
        for title, sky in skies.items()
    }
    shared = pictures["measured: Ithaca, 27 May 2013"].exposure()
    sheet("front", pictures, 4, [shared] * 4)


def charts():
    """Some plots."""
    model, sun = skyfit.preetham_sky(3.0), np.radians(55)
    save(plots.luminance_map(model, sun), "plot_luminance")
    save(plots.sun_path(np.radians(42.44)), "plot_sun_path")
    view = np.linspace(0, np.pi / 2, 60)
    tracks = {
        f"sun at {deg}°: zenith to horizon": np.asarray(
            model.xyY(np.radians(deg), view, np.pi / 2)
        )[:, :2]
        for deg in (20, 55, 80)
    }
    save(plots.chromaticity_diagram(tracks), "plot_chromaticity")
    skies = {"published": model, "CIE clear sky": cie_clear_sky(3.0)}
    save(plots.meridian_section(skies, sun), "plot_section")
    save(plots.error_map(model, cie_clear_sky(3.0), sun, "CIE clear over published"), "plot_error")


def formulas():
    """What formulas of turbidity and of aerial perspective give."""
    save(plots.meteorological_range_chart(), "meteorological_range")
    save(plots.path_error_chart(), "aerial_accuracy")
    save(plots.sunset_chart(), "aerial_sunset")


def marched():
    """A day and other scenes by the ray marcher."""
    save(marched_pictures.day_sheet(), "marched_day")
    save(marched_pictures.gallery(), "marched_gallery")


PICTURES = {
    "front": front,
    "landscapes": landscapes,
    "aerial": with_and_without,
    "shafts": shafts,
    "orientation": orientation,
    "domes": domes,
    "charts": charts,
    "formulas": formulas,
    "marched": marched,
}

if __name__ == "__main__":
    jax.config.update("jax_enable_x64", True)
    for wanted in sys.argv[1:] or PICTURES:
        PICTURES[wanted]()
