"""The simulator: spectral radiance of the sky by order of scattering.

How it works, file by file:

- `geometry`: straight rays over a planet, spherical or flat;
- `quadrature`: nodes, weights and interpolation, all known before anything is compiled;
- `paths`: density along rays, columns between eye and air, columns between air and sun;
- `single`: the first order, light scattered once;
- `harmonics`: spherical harmonics of the light field, in which scattering is a product;
- `orders`: the second and higher orders;
- `quality`: sizes of all of it;
- `simulate_sky`: the public verb.
"""
