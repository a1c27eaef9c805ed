"""The paper's atmosphere, by what can be chosen of it."""

import dataclasses
from dataclasses import dataclass
from typing import Any, ClassVar

from jaxtyping import ArrayLike

from ...atmosphere import Atmosphere
from ...errors import InputError
from ...preetham_air import TURBIDITY_MEANINGS, TurbidityMeaning, preetham_atmosphere


@dataclass(frozen=True)
class PaperAtmosphere:
    """The atmosphere of Preetham et al. (1999), all but its turbidity; see `preetham_atmosphere`.

    Args:
        turbidity_means: The definition by optical thickness, or appendix A.3's coefficients.
        ozone: Whether 3.5 mm of ozone absorb.
        ground_albedo: Lambertian, in [0, 1].
    """

    kind: ClassVar[str] = "preetham1999"
    swept: ClassVar[str] = "turbidity"

    turbidity_means: TurbidityMeaning = "optical thickness"
    ozone: bool = False
    ground_albedo: float = 0.0

    def __post_init__(self):
        """Refuse what no atmosphere can be made of."""
        if self.turbidity_means not in TURBIDITY_MEANINGS:
            expected = ", ".join(repr(choice) for choice in TURBIDITY_MEANINGS)
            raise InputError(
                f"PaperAtmosphere(turbidity_means=...): expected one of {expected}; "
                f"got {self.turbidity_means!r}"
            )
        if not 0 <= self.ground_albedo <= 1:
            raise InputError(
                f"PaperAtmosphere(ground_albedo=...): expected 0 to 1; got {self.ground_albedo}"
            )

    def build(
        self, turbidity: ArrayLike, wavelengths: ArrayLike, ground_albedo: float | None = None
    ) -> Atmosphere:
        """The atmosphere of one turbidity at wavelengths [nm], maybe over another ground."""
        return preetham_atmosphere(
            turbidity,
            wavelengths=wavelengths,
            turbidity_means=self.turbidity_means,
            ozone=self.ozone,
            ground_albedo=self.ground_albedo if ground_albedo is None else ground_albedo,
        )

    def to_dict(self) -> dict[str, Any]:
        """As plain numbers and words, for JSON."""
        return {"kind": self.kind, **dataclasses.asdict(self)}

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> "PaperAtmosphere":
        """Undo `to_dict`."""
        return cls(**{name: value for name, value in record.items() if name != "kind"})
