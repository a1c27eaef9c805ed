"""The single-scattering ray marcher of Nishita et al. (1993), as a tutorial explains it.

The tutorial, "Simulating the Colors of the Sky" (`scs` in names), marches 16 steps along each view
and 8 towards the sun from each of them, through air and haze of exponential density on a sphere.
`simulate(scs_atmosphere(), ..., orders=1)` is the same physics integrated to convergence.
"""

from .air import MarchedAir as MarchedAir, scs_air as scs_air, scs_atmosphere as scs_atmosphere
from .march import march as march
from .pictures import (
    camera_rays as camera_rays,
    day_frames as day_frames,
    fisheye_rays as fisheye_rays,
    tone_map as tone_map,
)
from .sky import MarchedSky as MarchedSky, scs_sky as scs_sky
from .table import (
    OpticalDepthTable as OpticalDepthTable,
    optical_depth_table as optical_depth_table,
)
from .terrain import HeightField as HeightField
