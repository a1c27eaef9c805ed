"""Speed of the published model's `xyz`: prints millions of directions per second.

    XLA_FLAGS=--xla_cpu_multi_thread_eigen=false taskset -c 0 python tests/benchmarks/bench_xyz.py

10⁶ random unit vectors in float32, compiled beforehand, one thread. Both clocks are printed: on a
machine with other work to do the processor's own is the nearer to the truth. `exp` of as many
numbers stands beside it, to tell a slow machine from a slow program.
"""

import platform
import sys
import time
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from skyfit.models import preetham_sky


COUNT, REPEAT = 10**6, 200


def directions():
    """Unit vectors of the upper half of the sphere, float32."""
    rng = np.random.default_rng(2)
    view = rng.standard_normal((COUNT, 3))
    view[:, 2] = np.abs(view[:, 2])
    return jnp.asarray(view / np.linalg.norm(view, axis=1)[:, None], jnp.float32)


def seconds(call):
    """Time of one call by the processor's clock and by the wall's: [repeat, 2]."""
    call().block_until_ready()
    spent = []
    for _ in range(REPEAT):
        start = time.process_time(), time.perf_counter()
        call().block_until_ready()
        spent.append((time.process_time() - start[0], time.perf_counter() - start[1]))
    return np.array(spent)


def report(name, spent):
    """Print the best and the median of both clocks."""
    speed = COUNT / spent / 1e6
    best, median = speed.max(axis=0), np.median(speed, axis=0)
    sys.stdout.write(
        f"{name:<6} million/s: processor's clock best {best[0]:.1f}, median {median[0]:.1f}; "
        f"wall clock best {best[1]:.1f}, median {median[1]:.1f}\n"
    )


def machine():
    """The processor's name."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def main():
    """Measure speed, and the error against float64."""
    view, sun = directions(), jnp.asarray([np.sin(1.0), 0.0, np.cos(1.0)], jnp.float32)
    evaluate, exponential = jax.jit(preetham_sky(3.0).xyz), jax.jit(jnp.exp)
    start = time.perf_counter()
    found = evaluate(view, sun).block_until_ready()
    sys.stdout.write(f"{machine()}; compiled in {time.perf_counter() - start:.1f} s\n")
    report("xyz", seconds(lambda: evaluate(view, sun)))
    heights = view[:, 2]
    report("exp", seconds(lambda: exponential(heights)))
    with jax.enable_x64(True):
        exact = preetham_sky(3.0).xyz(view.astype(jnp.float64), sun.astype(jnp.float64))
        error = jnp.max(jnp.abs(found / exact - 1))
    sys.stdout.write(f"largest relative error against float64: {error:.1e}\n")


if __name__ == "__main__":
    main()
