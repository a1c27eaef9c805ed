"""What made a record: versions of the packages whose code its numbers depend on."""

import platform
from importlib.metadata import PackageNotFoundError, version


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
