"""What an animation is made of is told to the last bit, and the same in every run."""

import numpy as np
import pytest
import xarray as xr

import skyfit
from skyfit.render import Fisheye, ModelSource, RecordedSource, SimulatedSource
from skyfit.render.frames import animation_record
from skyfit.render.identity import UnknownError, digest


CAMERA, SUNS = Fisheye(12), np.array([[1.2, 2.0]])
LIST = "a4f938545067415fca04735d910290298224f383558e857853b8ad8534b765fc"


class OwnSource(ModelSource):
    pass


def test_every_kind_of_sky_is_told_by_its_content():
    def record(sky):
        found = animation_record(sky, CAMERA, SUNS, {})
        assert found is not None
        return found["source"]

    air = skyfit.preetham_atmosphere(4.0, wavelengths=[450.0, 600.0])
    thicker = skyfit.preetham_atmosphere(4.001, wavelengths=[450.0, 600.0])
    data = xr.Dataset(
        {name: ("direction", [1.0, 2.0]) for name in ("luminance", "x", "y")}
        | {name: ("direction", [0.0, 1.0]) for name in ("view_zenith", "relative_azimuth")},
        coords={"sun_zenith": 1.0},
    )
    brighter = data.assign(luminance=data["luminance"] * (1 + 1e-15))
    dull = SimulatedSource(air, "air")
    dull.ground_albedo = 0.3
    skies = [
        SimulatedSource(air, "air"), SimulatedSource(thicker, "air"), dull,
        SimulatedSource(air, "air", orders=1), SimulatedSource(air, "air", observer_altitude=10.0),
        SimulatedSource(air, "air", quality="draft"), SimulatedSource(air, "air", grid=(9, 9)),
        RecordedSource(data, "data"), RecordedSource(brighter, "data"),
        RecordedSource(data, "data", 3.0),
        ModelSource(skyfit.preetham_sky(3.0), None, "model"),
        ModelSource(skyfit.preetham_sky(3.0), 3.0, "model"),
        ModelSource(skyfit.preetham_sky(3.5), 3.0, "model"),
    ]  # fmt: skip
    assert len({record(sky) for sky in skies}) == len(skies)
    # Made anew, and under another name, it is the same.
    same = skyfit.preetham_atmosphere(4.0, wavelengths=[450.0, 600.0])
    assert record(SimulatedSource(same, "elsewhere")) == record(skies[0])


def test_a_digest_tells_kinds_and_widths_apart():
    things = [
        None, True, 1, 1.0, "1", (1,), [1], {"1": 1}, ("a", "b"), ("ab",), (("a",), "b"),
        np.array(1.0), np.array([1.0]), np.array([[1.0]]), np.array([1.0], np.float32),
        np.array([1]), 0.0, -0.0, CAMERA, 12,
    ]  # fmt: skip
    assert len({digest(thing) for thing in things}) == len(things)
    # Of the text [1, 2.5, "a"] after its kind, by another program: sha256sum.
    assert digest([1, 2.5, "a"]) == LIST
    for unknown in (object(), len, {1, 2}, np.array([None]), OwnSource):
        with pytest.raises(UnknownError):
            digest(unknown)
