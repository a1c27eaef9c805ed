"""Sky formulas as source code for renderers."""

from .write import (
    FORMATS as FORMATS,
    TARGETS as TARGETS,
    export_fit as export_fit,
    radiance_scene as radiance_scene,
)
