"""The simulator: spectral radiance of the sky by order of scattering.

How it works, file by file:

- `geometry`: straight rays over a planet, spherical or flat;
- `quadrature`: nodes, weights and interpolation, all known before anything is compiled;
- `optics`: coefficients and phase functions, with forward peaks cut off exactly;
- `medium`: an atmosphere on its planet, its densities made cheap to integrate;
- `paths`: density along rays, and columns between eye and air;
- `nodes`: where on a ray light is looked at;
- `sight`: lines of sight, laid out once for all orders;
- `columns`: columns between air and sun;
- `single`: the first order, light scattered once;
- `harmonics`: spherical harmonics of a light field, in which scattering is a product;
- `fan`: the rays of one level;
- `field`: the light field between levels, and its first order;
- `orders`: the second and higher orders;
- `solve`: all orders at once;
- `views`: directions that share a sun or a line of sight;
- `quality`: sizes of all of it;
- `program`: the compiled whole;
- `trust`: what is refused, what is warned of, and an estimate of the error;
- `simulate_sky`: the public verb.
"""
