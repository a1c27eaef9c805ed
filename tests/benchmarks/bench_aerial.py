"""Time of aerial perspective for a million pixels: prints the measured figures.

    python tests/benchmarks/bench_aerial.py

Processor time is summed over the threads. The control is three exponentials per pixel.
"""

import sys
import time

import jax
import jax.numpy as jnp
import numpy as np

import skyfit
from skyfit.aerial import aerial_perspective


PIXELS = 10**6


def seconds(call, repeat=7):
    """Shortest wall and processor times of some calls, after one that compiles."""
    jax.block_until_ready(call())
    wall, cpu = [], []
    for _ in range(repeat):
        start, used = time.perf_counter(), time.process_time()
        jax.block_until_ready(call())
        wall.append(time.perf_counter() - start)
        cpu.append(time.process_time() - used)
    return min(wall), min(cpu)


def main():
    """Print one line per method, in float32 and RGB."""
    rng = np.random.default_rng(0)
    ranges = ((0.0, 5e4), (1.2, 1.7), (-np.pi, np.pi), (0.0, 1e3))
    rays = [jnp.asarray(rng.uniform(*r, PIXELS), jnp.float32) for r in ranges]
    light0 = jnp.asarray(rng.uniform(0, 1e4, (PIXELS, 3)), jnp.float32)

    def one(model, light0, *ray):
        return model.apply(light0, *ray)

    control = jax.jit(lambda light: jnp.exp(-light * 1e-4))
    report("exp alone", *seconds(lambda: control(light0)))
    for method in ("quadrature", "paper"):
        model = aerial_perspective(
            3.0, skyfit.preetham_sky(3.0), 1.2, channels="rgb", method=method
        )
        whole = jax.jit(one)
        each = jax.jit(jax.vmap(one, in_axes=(None, 0, 0, 0, 0, 0)))
        report(method, *seconds(lambda m=model, f=whole: f(m, light0, *rays)))
        report(f"{method}, vmap", *seconds(lambda m=model, f=each: f(m, light0, *rays)))


def report(name, wall, cpu):
    """Print a line at once."""
    sys.stdout.write(f"{name:18} {wall:.3f} s wall, {cpu:.3f} s processor, a million pixels\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
