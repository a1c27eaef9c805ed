"""Weather years that tests read: EnergyPlus and TMY3 files, made of pvlib's clear skies."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from peers import peer


@dataclass(frozen=True)
class Year:
    """A place and what its weather is like."""

    latitude: float
    longitude: float
    zone: float
    per_hour: int = 1
    overcast: bool = False
    offset: float = 0.0
    gaps: float = 0.0


YEARS = {
    "clear": Year(37.4, -122.0, -8),
    "overcast": Year(51.5, -0.1, 0, overcast=True),
    "polar": Year(78.2, 15.6, 1),
    "equator": Year(-0.2, -78.5, -5),
    "gaps": Year(48.2, 16.4, 1, gaps=0.1),
    "offsets": Year(28.6, 77.2, 5.5, offset=-1.0),
    "half-hours": Year(-37.8, 145.0, 10, per_hour=2),
}


def irradiance(year, days):
    """Times in the middle of each row, and what pvlib says of them; no file has been written."""
    pvlib = peer("pvlib")
    step = pd.Timedelta(hours=1) / year.per_hour
    starts = [pd.Timestamp("2023-01-01") + pd.Timedelta(days=int(day)) for day in days]
    rows = [start + k * step for start in starts for k in range(24 * year.per_hour)]
    index = (pd.DatetimeIndex(rows) + step / 2).tz_localize(int(3600 * year.zone))
    days = index.tz_convert("UTC").day_of_year.to_numpy()
    sun = pvlib.solarposition.spa_python(index, year.latitude, year.longitude, delta_t=69.0)
    top = pvlib.irradiance.get_extra_radiation(days, solar_constant=1367.0, method="spencer")
    mass = pvlib.atmosphere.get_relative_airmass(sun["zenith"], "kasten1966").fillna(0.0)
    depth = pvlib.clearsky.bird(sun["zenith"], mass, 0.1, 0.08, 2.0, dni_extra=top)
    up = sun["zenith"] < 90
    direct, diffuse = (depth[name].where(up, 0.0).fillna(0.0) for name in ("dni", "dhi"))
    if year.overcast:
        direct, diffuse = 0 * direct, 0.3 * depth["ghi"].fillna(0.0)
    table = pd.DataFrame({"dni": direct.round(1), "dhi": diffuse.round(1)}, index)
    dark = (table["dni"] + table["dhi"]) <= 0
    table[dark] = year.offset
    missing = np.random.default_rng(3).random(len(table)) < year.gaps
    table.loc[missing, "dhi"] = np.nan
    sunlit = table.assign(zenith=np.radians(sun["zenith"]), azimuth=np.radians(sun["azimuth"]))
    return sunlit.assign(top=top, mass=mass)


def write_epw(path, year, table):
    """The rows as an EnergyPlus file, which counts hours from 1 and marks gaps by 9999."""
    place = f"LOCATION,Nowhere,-,-,-,0,{year.latitude},{year.longitude},{year.zone},10.0"
    lines = [place, "DESIGN CONDITIONS,0", "TYPICAL/EXTREME PERIODS,0", "GROUND TEMPERATURES,0"]
    lines += ["HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0", "COMMENTS 1", "COMMENTS 2"]
    lines.append(f"DATA PERIODS,1,{year.per_hour},Data,Sunday, 1/ 1,12/31")
    for at, row in table.fillna(9999).iterrows():
        minute = 60 if year.per_hour == 1 else 30 if at.minute < 30 else 60
        values = [at.year, at.month, at.day, at.hour + 1, minute, "?9", *[0] * 7]
        values += [0, row["dni"], row["dhi"], *[0] * 19]
        lines.append(",".join(map(str, values)))
    path.write_text("\n".join(lines) + "\n", encoding="latin-1")


def write_tmy3(path, year, table):
    """The rows as a TMY3 file, whose hours end at their time and whose gaps are -9900."""
    lines = [f'000001,"NOWHERE",XX,{year.zone},{year.latitude},{year.longitude},10']
    lines.append("Date (MM/DD/YYYY),Time (HH:MM),GHI (W/m^2),DNI (W/m^2),DHI (W/m^2)")
    for at, row in table.fillna(-9900).iterrows():
        lines.append(f"{at:%m/%d/%Y},{at.hour + 1:02d}:00,0,{row['dni']},{row['dhi']}")
    path.write_text("\n".join(lines) + "\n")
