"""Pictures of skies: fisheye domes, panoramas, perspectives; EXR, HDR, PNG.

`render(source, camera, sun_zenith, sun_azimuth)` makes a `Picture` in absolute luminance, and
`Picture.save` writes it. A source comes from `load_source` or from a class of its own.
"""

from .cameras import (
    PROJECTIONS as PROJECTIONS,
    AbstractCamera as AbstractCamera,
    Fisheye as Fisheye,
    Panorama as Panorama,
    Perspective as Perspective,
)
from .files import PRECISIONS as PRECISIONS, check_target as check_target
from .picture import (
    Picture as Picture,
    horizontal_irradiance as horizontal_irradiance,
    render as render,
)
from .source_files import load_source as load_source
from .sources import AbstractSource as AbstractSource, ModelSource as ModelSource
from .tone import GAMUTS as GAMUTS, TONES as TONES
