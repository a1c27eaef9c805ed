"""Where the time goes: stages by the wall clock, with XLA's compiling counted apart."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

import jax


_COMPILE_EVENTS = ("jaxpr_trace", "jaxpr_to_mlir_module", "backend_compile")


class Clock:
    """Seconds spent in each stage, less what was spent on compiling meanwhile.

    Attributes:
        seconds: Seconds by stage; under "compile" what tracing and compiling took in all of them.
    """

    def __init__(self):
        self.seconds: dict[str, float] = {"compile": 0.0}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count what happens within as this stage. Stages must not nest."""
        compiled = self.seconds["compile"]
        start = time.perf_counter()
        jax.monitoring.register_event_duration_secs_listener(self._listen)
        try:
            yield
        finally:
            jax.monitoring.unregister_event_duration_listener(self._listen)
            spent = time.perf_counter() - start - (self.seconds["compile"] - compiled)
            self.seconds[name] = self.seconds.get(name, 0.0) + spent

    def _listen(self, event: str, duration_secs: float, **kwargs: str | int) -> None:
        if any(name in event for name in _COMPILE_EVENTS):
            self.seconds["compile"] += duration_secs
