"""Time of pictures: prints seconds by the wall clock and by the processor, first and later calls.

python tests/benchmarks/bench_render.py [formula] [simulated] [terrain]
"""

import sys
import time

import jax
import numpy as np

import skyfit
from skyfit.render import (
    Fisheye,
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


def timed(name, call):
    """Run twice and print both times."""
    for which in ("first", "again"):
        wall, work = time.perf_counter(), time.process_time()
        result = call()
        wall, work = time.perf_counter() - wall, time.process_time() - work
        print(f"{name:<44} {which}: {wall:7.3f} s, {work:7.3f} s of processor", flush=True)
    return result


def formula():
    """A model's fisheye, and what a panorama sends onto the ground."""
    source = load_source(None, 3.0)
    suns = iter(np.radians([40.0, 50.0]))
    timed(
        "fisheye 512 x 512, as 8-bit pixels",
        lambda: render(source, Fisheye(512), next(suns)).pixels(),
    )
    picture = render(source, Panorama(512), 0.9, sun_disc=False, ground_albedo=0.0)
    rays = picture.camera.rays()
    light = picture.rgb @ np.array([0.2126, 0.7152, 0.0722])
    sent = np.sum(light * np.maximum(rays.direction[..., 2], 0) * rays.solid_angle)
    expected = horizontal_irradiance(source, 0.9, np.pi)[1]
    print(f"panorama 1024 x 512, irradiance over the model's: {sent / expected:.5f}")


def simulated():
    """A simulated fisheye of 41 wavelengths and two orders, and the error of its interpolation."""
    air = skyfit.preetham_atmosphere(3.0)
    source = SimulatedSource(air, "simulated")
    suns = iter(np.radians([50.0, 65.0]))
    timed("simulated fisheye 512 x 512", lambda: render(source, Fisheye(512), next(suns)))


def terrain():
    """A landscape of 1000 x 750 pixels and 16 samples with aerial perspective."""
    source, land, sun = load_source(None, 2.0), sample_elevation(), np.radians(65.0)
    camera = Perspective(1000, 750, np.radians(270), np.radians(-5), np.radians(55), 120.0)
    eye = (16265.0, 4255.0)

    def frame():
        air = air_before(source, sun)
        return render_terrain(source, land, camera, eye, sun, np.radians(100), air)

    timed("landscape 1000 x 750, 16 samples", frame)


if __name__ == "__main__":
    jax.config.update("jax_enable_x64", True)
    parts = {"formula": formula, "simulated": simulated, "terrain": terrain}
    for part in sys.argv[1:] or parts:
        parts[part]()
