"""How long skies take, how much memory, and how close they come."""

from .run import run_benchmarks as run_benchmarks
