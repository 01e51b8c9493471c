"""Numbers of the search for a payload."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PayloadSettings:
    """How a difference in payload is looked for. Chosen on one arm of six joints and on made arms of two.

    Attributes:
        cutoff: Of the low pass that torque and motion share [Hz]: above the motions of an arm, below its oscillations.
        rate: Of the rows behind it [Hz].
        edge: Time at both ends of a session that is left out [s], where the filter settles.
        slow: Part of the top speed over which friction changes its sign.
        top: Quantile of the speed that counts as the top speed.
        folds: Blocks that are left out in turn for the deviations.
        rank: Singular value, over the largest, below which a combination of weights is not seen.
        seen: The same for the columns of the payload.
        told: Part of a moment that may lie outside of what the rows fix: a larger one tells numbers that are none.
        dust: Size of a column, over the largest, that rounding leaves of a body that this joint does not move.
        significant: Standard deviations from which a payload differs. A smaller value names payloads by chance: the
            deviations come from eight blocks alone.
        test_share: Part of each session, its last, on which errors are counted.
        most_joints: Joints that are told to show it.
    """

    cutoff: float = 5.0
    rate: float = 25.0
    edge: float = 1.0
    slow: float = 0.03
    top: float = 0.95
    folds: int = 8
    rank: float = 1e-5
    seen: float = 1e-4
    told: float = 0.01
    dust: float = 1e-9
    significant: float = 4.0
    test_share: float = 1.0 / 3.0
    most_joints: int = 3


SETTINGS = PayloadSettings()
