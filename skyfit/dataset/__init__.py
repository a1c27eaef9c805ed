"""The record between simulation and fit: an xarray dataset, how it is made and where it is kept.

Dimensions are the swept parameters (`turbidity`, or any other; none where nothing is swept; one
`sample` where they vary together), `sun_zenith`, `direction` and `wavelength`, plus `order` where
the orders of scattering are kept.
Angles are in radians. Attributes describe the atmospheres and the versions that made the record, so
that it can be simulated or fitted again from the file alone. Where the error was estimated, the
attribute `error_estimate` sums it up, and the variable of that name has it for every radiance if
every sky was checked.

- `runner`: `run_campaign`, which simulates what is not done yet;
- `store`: a store that keeps every finished sky, by which the same campaign goes on;
- `record`: what a dataset holds; `form`: what is refused of a stranger's;
- `files`: `save_dataset` and `load_dataset`;
- `measurements`, `aeronet`: measured skies and aerosols.
"""

from .files import (
    SUFFIXES as SUFFIXES,
    load_dataset as load_dataset,
    save_dataset as save_dataset,
)
from .record import (
    SCHEMA as SCHEMA,
    campaign_of as campaign_of,
    describe as describe,
    sky_variables as sky_variables,
)
