"""Fitting closed formulas to skies, by Levenberg-Marquardt, with what a sceptic asks of a fit.

- `skies`, `channels`: what is fitted, read from a dataset;
- `choices`: distribution, dependence, weights and the like;
- `targets`, `problem`: residuals; `solver`: the algorithm; `lanes`, `batch`: many fits side by
  side, their tolerances and starts;
- `scales`: zeniths and other scales; `diagnostics`, `positivity`: how good a fit is;
- `fit`: `fit_sky`; `each_sky`: every sky by itself; `record`: `SkyFit`;
- `files`, `document`, `schema`, `older_files`: fits as JSON; `shipped`: the refit of the package.
"""

from .dependence import Dependence as Dependence
from .each_sky import EachSky as EachSky, fit_each_sky as fit_each_sky
from .files import load_fit as load_fit
from .fit import fit_sky as fit_sky
from .positivity import Positivity as Positivity, positivity as positivity
from .record import SkyFit as SkyFit
from .shipped import paper_refit as paper_refit
