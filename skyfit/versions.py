"""Which release of a package is installed."""

from importlib.metadata import PackageNotFoundError, version


def version_of(package: str) -> str:
    """Version of an installed package, "unreleased" when it runs from a source tree."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "unreleased"
