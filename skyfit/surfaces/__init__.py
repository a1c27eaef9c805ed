"""What a sky does to surfaces: light on planes, spherical harmonics, directions to sample.

Everything starts from a `Dome`, the light of any sky (a formula, a simulation or a measurement)
under one sun: `sky_dome` or `sampled_dome`.
"""

from .dome import Dome as Dome, sky_dome as sky_dome
from .harmonics import (
    harmonic_irradiance as harmonic_irradiance,
    harmonic_light as harmonic_light,
    project as project,
    real_harmonics as real_harmonics,
)
from .planes import PlaneLight as PlaneLight, plane_light as plane_light, sun_light as sun_light
from .sampled import sampled_dome as sampled_dome
from .sampling import SkySampler as SkySampler, sky_sampler as sky_sampler
