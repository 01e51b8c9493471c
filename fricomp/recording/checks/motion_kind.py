"""What a motion can show: one that goes one way, an output that is held, a joint that is moved by hand.

Each of them shows something, and none of them shows the friction of both directions; what it is is said with figures.
"""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.torque_causes import fit_joint
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording

__all__ = ["find_hand_motion", "find_held_output", "find_one_way"]

Samples = NDArray[np.float64]

_BLOCKS = 400
"""Stretches that a motion is cut into: shorter ones would show the noise of an encoder as a way back."""
_BACK = 0.02
"""Part of the way that leads back, below which a motion goes one way."""
_HELD_TRAVEL = {"rotary": 0.25, "linear": 0.01}
"""Travel above which an output is not held [rad] or [m]: gear and clamp give by a few degrees."""
_FOLLOWS = 0.9
"""Correlation of position and torque above which the position follows the torque."""
_LOADED, _UNLOADED = 0.4, 0.08
"""Parts of the largest torque: above the first a gap is closed, below the second the load is off."""
_NO_FRICTION = 0.01
"""Friction over the torque's deviation, below which none shows."""
_BY_ANGLE = 0.98
"""Part of the torque's variance that gravity must explain where no friction shows."""


def find_one_way(recording: Recording) -> tuple[Finding, ...]:
    """A motion in one direction: friction and a constant torque cannot be told apart in it."""
    step = np.diff(recording.position[:: max(1, len(recording) // _BLOCKS)])
    path = float(np.abs(step).sum())
    if path == 0.0:
        return ()
    back = min(float(step[step > 0.0].sum()), -float(step[step < 0.0].sum()))
    if back > _BACK * path:
        return ()
    message = (
        "the joint moves in one direction only: friction cannot be told from a constant torque, nor from an error of "
        "gravity; what it shows is the sum of them over speed"
    )
    return (Finding("one_way", "warning", message, "record both directions", column="position"),)


def find_held_output(recording: Recording) -> tuple[Finding, ...]:
    """An output that is held: the position follows the torque, by elasticity and lost motion, and nothing slides."""
    position, torque = np.asarray(recording.position), np.asarray(recording.torque)
    travel = float(np.ptp(position))
    if travel == 0.0 or travel > _HELD_TRAVEL[recording.metadata.motion] or float(np.std(torque)) == 0.0:
        return ()
    if float(np.corrcoef(position, torque)[0, 1]) < _FOLLOWS:
        return ()
    top = float(np.abs(torque).max())
    slopes = [_slope(torque[rows], position[rows]) for rows in (torque > _LOADED * top, torque < -_LOADED * top)]
    known = [slope for slope in slopes if slope > 0.0]
    unit, angle = recording.metadata.torque_unit, recording.metadata.position_unit
    stiffness = f"{len(known) / sum(known):.3g} {unit}/{angle}" if known else "not determined"
    lost = _lost_motion(position, torque, top)
    message = (
        f"the output is held and the position follows the torque: stiffness {stiffness}, lost motion {1e3 * lost:.3g} "
        f"m{angle} where the torque passes zero; nothing slides, so that this shows no friction of sliding"
    )
    return (Finding("held_output", "warning", message, "free the output to identify friction", column="position"),)


def find_hand_motion(recording: Recording) -> tuple[Finding, ...]:
    """A torque that follows the angle alone: who moves the joint pays its friction."""
    if recording.metadata.motion != "rotary":
        return ()
    fit = fit_joint(recording)
    size = float(np.std(recording.torque))
    if fit is None or abs(fit.friction) > _NO_FRICTION * size or fit.explained < _BY_ANGLE:
        return ()
    if abs(fit.inertia) > 3.0 * fit.deviations[0] and np.isfinite(fit.deviations[0]):
        return ()
    message = (
        f"the torque follows the angle alone, and friction is below {_NO_FRICTION:.0%} of it: the joint is moved by "
        "hand, or by something else that pays its friction; no friction is seen, which does not say that there is none"
    )
    return (Finding("hand_motion", "warning", message, "let the joint's own torque move it", column="torque"),)


def _slope(torque: Samples, position: Samples) -> float:
    """Compliance in a stretch under load [rad/N·m] or [m/N]; 0 where there are too few samples."""
    if torque.size < 20 or float(np.ptp(torque)) == 0.0:
        return 0.0
    return float(np.polyfit(torque, position, 1)[0])


def _lost_motion(position: Samples, torque: Samples, top: float) -> float:
    """Distance between the ways of rising and falling torque where it passes zero [rad] or [m]."""
    window = np.ones(9) / 9.0
    rising = np.gradient(np.convolve(torque, window, mode="same"))
    near = np.abs(torque) < _UNLOADED * top
    up, down = position[near & (rising > 0.0)], position[near & (rising < 0.0)]
    return float(abs(np.median(up) - np.median(down))) if min(up.size, down.size) > 5 else 0.0
