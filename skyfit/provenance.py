"""What made a record: the machine, and versions of the packages that its numbers depend on."""

import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def package_version(package: str) -> str:
    """Version of an installed package; "unreleased" where skyfit runs from a source tree."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "unreleased"


def versions(*packages: str) -> dict[str, str]:
    """Versions of Python, skyfit, JAX, Equinox and NumPy, and of other packages by name."""
    named = ("skyfit", "jax", "equinox", "numpy", *packages)
    found = {name: package_version(name) for name in named}
    return found | {"python": platform.python_version()}


def processor() -> str:
    """Model of this machine's processor, as far as it can be told."""
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(errors="replace").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
