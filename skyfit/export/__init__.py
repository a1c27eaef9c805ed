"""Sky formulas as source code for renderers."""

from .write import FORMATS as FORMATS, export_fit as export_fit
