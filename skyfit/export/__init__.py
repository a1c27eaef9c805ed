"""Sky formulas as source code for renderers.

- `formula`, `distributions`, `dependence`, `scales`, `frame`: a fit as functions of expressions;
- `description`: what those are; `names`: what parameters are called in code;
- `screen`: the sun's disc, a tone curve and the encoding of a picture;
- `dialect`, `languages`: expressions in GLSL, HLSL, C, JavaScript and Python;
- `heading`: where a formula is from, as a comment;
- `targets`, `radiance`: files of renderers; `write`: all of it as text.
"""

from .write import (
    FORMATS as FORMATS,
    TARGETS as TARGETS,
    export_fit as export_fit,
    radiance_scene as radiance_scene,
)
