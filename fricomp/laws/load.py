"""How dry friction follows the normal load on its contact."""

from dataclasses import dataclass
from typing import Any

from fricomp.laws.term import OperatingPoint, require_nonnegative, require_positive


@dataclass(frozen=True)
class LoadScaling:
    """Factor on the dry part of a friction law: 1 + k (N / N_ref - 1).

    With k = 1 dry friction is proportional to the normal load (Amontons); with k = 0 it does not depend on it.
    Viscous friction comes from the lubricant and is not scaled.

    Attributes:
        load_sensitivity: k, between "not at all" and "proportional" [1].
        reference_load: N_ref, the load at which the law's parameters hold; [N] or any unit that the loads share,
            which a model file calls "as normal_load".
    """

    load_sensitivity: float = 1.0
    reference_load: float = 1.0

    def __post_init__(self) -> None:
        require_nonnegative(self, "load_sensitivity")
        require_positive(self, "reference_load")

    def factor(self, normal_load: Any) -> Any:
        """Factor on dry friction [1] under `normal_load`; 1 where the load is None."""
        if normal_load is None:
            return 1.0
        return 1.0 + self.load_sensitivity * (normal_load / self.reference_load - 1.0)

    def factor_at(self, point: OperatingPoint) -> Any:
        """Factor on dry friction [1] at `point`; 1 where its normal load is unknown."""
        return self.factor(point.normal_load_or(self.reference_load))
