"""Pictures of skies: fisheye domes, panoramas, perspectives; EXR, HDR, PNG.

`render(source, camera, sun_zenith, sun_azimuth)` makes a `Picture` in absolute luminance, and
`Picture.save` writes it. A source comes from `load_source` or from a class of its own.
"""

from .air import AIRS as AIRS, air_before as air_before
from .animation import animate as animate, day_of_suns as day_of_suns
from .cameras import (
    PROJECTIONS as PROJECTIONS,
    AbstractCamera as AbstractCamera,
    Fisheye as Fisheye,
    Panorama as Panorama,
    Perspective as Perspective,
)
from .elevation import Elevation as Elevation
from .elevation_files import (
    load_elevation as load_elevation,
    sample_elevation as sample_elevation,
)
from .files import PRECISIONS as PRECISIONS, check_target as check_target
from .frames import frames_directory as frames_directory
from .photographs import read_fisheye as read_fisheye
from .picture import (
    Picture as Picture,
    horizontal_irradiance as horizontal_irradiance,
    render as render,
)
from .read_pictures import read_picture as read_picture
from .recorded import RecordedSource as RecordedSource, select_sky as select_sky
from .simulated import SimulatedSource as SimulatedSource
from .source_files import load_source as load_source, sun_of as sun_of
from .sources import AbstractSource as AbstractSource, ModelSource as ModelSource
from .terrain import render_terrain as render_terrain
from .tone import GAMUTS as GAMUTS, TONES as TONES
