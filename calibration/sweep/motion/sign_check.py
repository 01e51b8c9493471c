"""The first motion of all: a low torque that rises until the joint moves, to see that signs and scales are right."""

from dataclasses import dataclass

import numpy as np

from fricomp.errors import SweepAborted
from fricomp.recording import Recording

__all__ = ["SignCheck", "check_signs"]

# Ratios further off than this are a wrong unit or scale, not a tolerance.
LOWEST_RATIO, HIGHEST_RATIO = 0.5, 2.0


@dataclass(frozen=True)
class SignCheck:
    """What a low torque did.

    Attributes:
        torque: Commanded when the joint began to move [N·m], [N] or the actuator's own unit.
        moved: How far it went [rad] or [m].
        velocity_ratio: Distance by the reported velocity over distance by the position [1]; None if not reported.
        torque_ratio: Reported over commanded torque [1]; None where the two are the same thing.
    """

    torque: float
    moved: float
    velocity_ratio: float | None
    torque_ratio: float | None


def check_signs(samples: Recording, *, torque_is_echo: bool) -> SignCheck:
    """Compare what was commanded with what was reported.

    Args:
        samples: Of the rising torque, until the joint moved; with `torque_command`.
        torque_is_echo: Whether the reported torque is the command itself.

    Raises:
        SweepAborted: A sign or a scale is wrong; nothing else is worth trying before that is put right.
    """
    command = samples.torque_command if samples.torque_command is not None else samples.torque
    moved = float(samples.position[-1] - samples.position[0])
    pushed = float(command[np.argmax(np.abs(command))])
    joint = samples.metadata.joint
    if moved * pushed < 0.0:
        raise SweepAborted(
            f"joint {joint!r} moved by {moved:+.3g} under {pushed:+.3g}: torque and position count in opposite "
            "directions; set sign = -1 in the joint's transmission"
        )
    velocity_ratio = _measure_velocity_ratio(samples, moved)
    if velocity_ratio is not None and not LOWEST_RATIO < velocity_ratio < HIGHEST_RATIO:
        raise SweepAborted(
            f"joint {joint!r}: the reported velocity adds up to {velocity_ratio:.3g} times the distance travelled; "
            "check its unit (57.3 is degrees against radians, 6.28 turns) and its sign"
        )
    torque_ratio = None if torque_is_echo else _measure_torque_ratio(samples, command)
    if torque_ratio is not None and not LOWEST_RATIO < torque_ratio < HIGHEST_RATIO:
        raise SweepAborted(
            f"joint {joint!r}: the reported torque is {torque_ratio:.3g} times the commanded one; check gear ratio, "
            "torque constant and sign"
        )
    return SignCheck(pushed, moved, velocity_ratio, torque_ratio)


def _measure_velocity_ratio(samples: Recording, moved: float) -> float | None:
    if samples.velocity is None or moved == 0.0:
        return None
    return float(np.trapezoid(samples.velocity, samples.time) / moved)


def _measure_torque_ratio(samples: Recording, command: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float | None:
    """Slope of reported over commanded torque, free of an offset."""
    centred = command - command.mean()
    power = float(centred @ centred)
    return float(centred @ samples.torque) / power if power > 0.0 else None
