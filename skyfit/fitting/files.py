"""Reading a fit file back, whatever formula it holds."""

from os import PathLike
from pathlib import Path
from typing import Any

from .document import read_document
from .formula_record import FormulaFit
from .record import SkyFit


_FORMS: dict[str, Any] = {"published": SkyFit, "formula": FormulaFit}


def load_fit(path: str | PathLike[str]) -> SkyFit | FormulaFit:
    """Read a fit back.

    Returns:
        A `SkyFit` if the file holds the published form, else a `FormulaFit`.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not a fit, is of a later version, or a key is missing or of wrong shape;
            the message names the file and the key.
    """
    document = read_document(Path(path))
    form = document["form"]
    if form not in _FORMS:
        raise ValueError(f"{path}: form: expected one of {tuple(_FORMS)}; got {form!r}")
    try:
        return _FORMS[form].from_document(path, document)
    except KeyError as error:
        raise ValueError(f"{path}: key {error} is missing") from error
