"""Which skies to simulate: campaigns, their files, and the atmospheres that files describe.

Carrying a campaign out, and going on after an interruption, is `skyfit.dataset`'s.

- `campaign`: a campaign; `checks`, `given`, `swept`: what it may be made of; `places`: where its
  atmospheres lie among the swept parameters;
- `directions`: the paper's suns and directions;
- `description/`: atmospheres as numbers: gases, aerosols, profiles, suns;
- `plain`: atmospheres as names and numbers for JSON, and back;
- `file/`: campaign files; imported apart, for it brings pydantic.
"""

from .campaign import GEOMETRIES as GEOMETRIES, SCHEMA as SCHEMA, Campaign as Campaign
from .description import (
    DescribedAtmosphere as DescribedAtmosphere,
    PaperAtmosphere as PaperAtmosphere,
    Sweep as Sweep,
)
from .directions import (
    PAPER_RELATIVE_AZIMUTHS_DEG as PAPER_RELATIVE_AZIMUTHS_DEG,
    PAPER_SUN_ZENITHS_DEG as PAPER_SUN_ZENITHS_DEG,
    PAPER_TURBIDITIES as PAPER_TURBIDITIES,
    PAPER_VIEW_ZENITHS_DEG as PAPER_VIEW_ZENITHS_DEG,
    half_dome as half_dome,
    paper_directions as paper_directions,
)
