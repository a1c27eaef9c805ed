"""Between two skies: the fitted clear sky and the overcast one, for turbidities too high for it."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._typing import ArrayLike, as_float, check
from ..colour import xyY_to_xyz, xyz_to_xyY
from ..errors import InputError
from .base import AbstractSkyModel
from .cie import cie_overcast_sky
from .preetham import preetham_sky


class BlendedSky(AbstractSkyModel):
    """A mixture of the light of two skies.

    Attributes:
        clear: The one.
        overcast: The other.
        cover: Share of the other, 0 to 1; broadcasts against the angles.
    """

    clear: AbstractSkyModel
    overcast: AbstractSkyModel
    cover: Float[Array, "..."]

    @property
    def valid_range(self) -> dict[str, tuple[float, float]]:
        """What holds for both skies, and for the share."""
        return self.clear.valid_range | self.overcast.valid_range | {"cover": (0.0, 1.0)}

    def xyY(
        self, sun_zenith: ArrayLike, view_zenith: ArrayLike, relative_azimuth: ArrayLike
    ) -> Float[Array, "*batch 3"]:
        """Chromaticity x, y and luminance Y [cd m⁻²]; see `AbstractSkyModel.xyY`."""
        angles = sun_zenith, view_zenith, relative_azimuth
        clear, overcast = (xyY_to_xyz(s.xyY(*angles)) for s in (self.clear, self.overcast))
        return xyz_to_xyY(self._mixed(clear, overcast))

    def xyz(self, direction: ArrayLike, sun_direction: ArrayLike) -> Float[Array, "*batch 3"]:
        """CIE XYZ [cd m⁻²] for unit vectors, z up; see `AbstractSkyModel.xyz`."""
        seen = direction, sun_direction
        return self._mixed(self.clear.xyz(*seen), self.overcast.xyz(*seen))

    def _mixed(self, clear, overcast):
        return _mixed(self.cover, clear, overcast)


@jax.jit
def _mixed(cover, clear, overcast):
    rank = max(cover.ndim + 1, clear.ndim, overcast.ndim)
    share, clear, overcast = (
        array.reshape((1,) * (rank - array.ndim) + array.shape)
        for array in (cover.astype(clear.dtype)[..., None], clear, overcast)
    )
    return (1 - share) * clear + share * overcast


def overcast_blend_sky(
    turbidity: ArrayLike, *, clear_up_to: float = 6.0, overcast_from: float = 10.0
) -> BlendedSky:
    """The published sky, giving way to the CIE's overcast one where turbidity is high.

    The paper asks for an interpolation at "intermediate turbidities" and shows turbidity 10 as
    overcast; it was fitted up to 6. The light of both is mixed; the share of the overcast sky rises
    from 0 to 1 with a slope that has no kink (t² (3 - 2t)).

    Args:
        turbidity: T, 1 or more; an array broadcasts against the angles.
        clear_up_to: Turbidity up to which the sky is the published one.
        overcast_from: Turbidity from which it is overcast.

    Raises:
        InputError: Turbidity below 1 or NaN; limits that do not increase from 1.9 to at most 10.

    Source: Preetham et al. (1999), section 5.
    """
    if not 1.9 <= clear_up_to < overcast_from <= 10.0:
        raise InputError(
            "overcast_blend_sky(clear_up_to=..., overcast_from=...): expected limits that increase "
            f"within 1.9 to 10; got {clear_up_to} and {overcast_from}"
        )
    message = "overcast_blend_sky(turbidity=...) must be 1 or more"
    value = check(as_float(turbidity), lambda v: ~((v >= 1) & (v < np.inf)), message)
    t = jnp.clip((value - clear_up_to) / (overcast_from - clear_up_to), 0.0, 1.0)
    # Above the end the published sky has no share.
    clear = preetham_sky(jnp.minimum(value, overcast_from))
    return BlendedSky(clear, cie_overcast_sky(), t**2 * (3 - 2 * t))
