"""The simulator: spectral radiance of the sky by order of scattering.

How it works, file by file:

- `geometry`: straight rays over a planet, spherical or flat;
- `quadrature`: nodes, weights and interpolation, all known before anything is compiled;
- `medium`: an atmosphere on its planet, its densities made cheap to integrate;
- `paths`: density along rays, and columns between eye and air;
- `columns`: columns between air and sun;
- `single`: the first order, light scattered once;
- `harmonics`: spherical harmonics of a light field, in which scattering is a product;
- `fan`: the rays of one level;
- `field`: the light field between levels, and its first order;
- `orders`: the second and higher orders;
- `views`: directions that share a sun or a line of sight;
- `quality`: sizes of all of it;
- `simulate_sky`: the public verb.
"""
