"""Reading campaign files."""

import tomllib
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ..._files import read_text
from ..._typing import ArrayLike
from ...atmosphere import Atmosphere
from ...errors import InputError
from ..campaign import Campaign
from ..description import PaperAtmosphere
from ..description.sweep import GROUND_ALBEDO
from .file import File
from .section import one_line


_MOST_BYTES = 50_000_000
PAPER_TURBIDITY = 3.0  # of the paper's atmosphere where none is asked for


def load_campaign(path: str | PathLike[str]) -> Campaign:
    """Read a campaign file.

    Args:
        path: A TOML file; `sims/preetham1999.toml` shows the keys of the sampling with their
            defaults, `sims/README.md` those of atmospheres.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: One line that names the file, the key, what was expected and what came.
    """
    content = _read(path)
    try:
        file = _file(path, content)
        campaign = file.campaign()
        # What only building can find impossible is better known now.
        for place in (campaign.places[0], campaign.places[-1]):
            campaign.build_atmosphere(**place)
    except (InputError, ValidationError) as error:
        raise _named(path, error) from None
    return campaign


def load_atmosphere(
    path: str | PathLike[str], wavelengths: ArrayLike | None = None, **swept: float | int
) -> Atmosphere:
    """The atmosphere of a campaign file.

    Args:
        path: A TOML file.
        wavelengths: Wavelengths of the atmosphere, increasing; the file's by default [nm].
        **swept: Parameters that the file sweeps under their own names, in the file's units, as in
            `optical_depth=0.3`. By default each has the value that the file gives where the
            parameter stands; the paper's atmosphere has a turbidity of 3.

    Raises:
        FileNotFoundError: There is no such file.
        InputError: One line that names the file, the key, what was expected and what came.
    """
    content = _read(path)
    try:
        file = _file(path, content)
        campaign = file.campaign()
        names = list(campaign.swept)
        if odd := set(swept) - set(names):
            expected = ", ".join(names) or "none"
            raise InputError(f"load_atmosphere: expected the parameter {expected}; got "
                             f"{', '.join(sorted(odd))}")  # fmt: skip
        lam: Any = campaign.wavelengths if wavelengths is None else wavelengths
        lam = np.atleast_1d(np.asarray(lam, float))
        given = {one.key: float(swept[one.name]) for one in campaign.sweep if one.name in swept}
        air: Any = campaign.atmosphere
        if isinstance(air, PaperAtmosphere):
            turbidity = float(swept.get("turbidity", PAPER_TURBIDITY))
            return air.build(turbidity, lam, given.get(GROUND_ALBEDO))
        return air.build(lam, given)
    except (InputError, ValidationError) as error:
        raise _named(path, error) from None


def _read(path: str | PathLike[str]) -> dict[str, Any]:
    text = read_text(path, _MOST_BYTES)
    try:
        content = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also a whole number of too many digits
        raise InputError(f"{path}: not a TOML file: {error}") from None
    return content


def _file(path: str | PathLike[str], content: dict[str, Any]) -> File:
    return File.model_validate(content, context={"folder": str(Path(path).parent)})


def _named(path: str | PathLike[str], error: InputError | ValidationError) -> InputError:
    if isinstance(error, ValidationError):
        return InputError(f"{path}: {one_line(error)}")
    return InputError(f"{path}: {error}")
