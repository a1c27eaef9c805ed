"""Physical constants: plain Python floats in SI units, each with its source."""

import math


EARTH_RADIUS = 6.360e6  # m; Bruneton & Neyret (2008), "Precomputed atmospheric scattering"
TOP_OF_ATMOSPHERE = 60e3  # m above the ground; the air density there is 2.5e-4 of the ground's

# Preetham, Shirley & Smits (1999), appendix A.3
AIR_REFRACTIVE_INDEX = 1.0003  # visible spectrum
AIR_NUMBER_DENSITY = 2.545e25  # m^-3 at 288.15 K and 1013 mbar (the paper prints 228.15 K)
PAPER_DEPOLARISATION = 0.035
JUNGE_EXPONENT = 4  # size distribution of the haze

LOSCHMIDT = 2.686780111e25  # m^-3; CODATA 2018, at 273.15 K and 101.325 kPa: a Dobson unit's gas
SUN_SOLID_ANGLE = 6.80e-5  # sr at one astronomical unit: angular radius 959.63" (IAU 1976)
SUN_ANGULAR_RADIUS = math.acos(1 - SUN_SOLID_ANGLE / (2 * math.pi))  # rad, of that solid angle
LUMINOUS_EFFICACY = 683.002  # lm/W at 555 nm, CIE 018:2019, K_m for standard air
TURBIDITY_WAVELENGTH = 550.0  # nm; Preetham et al. (1999), section 2.1
SUN_RADIUS = 6.957e8  # m; IAU 2015 resolution B3, nominal
ASTRONOMICAL_UNIT = 1.495978707e11  # m; IAU 2012 resolution B2
