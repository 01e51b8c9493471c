"""What a motion can show: one that goes one way, an output that is held, a joint that is moved by hand.

Each of them shows something, and none of them shows the friction of both directions; what it is is said with figures.
"""

from typing import NamedTuple

import numpy as np

from fricomp.recording.checks.joint_fit import fit_joint
from fricomp.recording.checks.quantum import measure_quantum
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

SHOWS_NO_SLIDING = frozenset({"no_sliding", "held_output", "hand_motion", "silent_torque", "stepped"})
"""Codes of findings after which no friction of sliding can be identified, whatever a fit gives."""

_BLOCKS = 400
"""Stretches that a motion is cut into: shorter ones would show the noise of an encoder as a way back."""
_BACK = 0.02
"""Part of the way that leads back, below which a motion goes one way."""
_AGAIN = 6.0 * np.pi
"""Way in one direction from which on each angle comes three times [rad]."""
_HELD_TRAVEL = {"rotary": 0.25, "linear": 0.01}
"""Travel above which an output is not held [rad] or [m]: gear and clamp give by a few degrees."""
_FOLLOWS = 0.9
"""Correlation of position and torque above which the position follows the torque."""
_CLAMP_ROWS = 2000
"""Most rows to which a held output is fitted."""
_CLAMP_MEAN = 9
"""Rows over which its torque is averaged. Odd."""
_WIDEST, _WIDTHS = 0.35, 22
"""Largest inner friction that is tried, as a part of the largest torque, and how many are."""
_CLOSING = (0.02, 0.05, 0.1)
"""Torque within which a gap closes, as a part of the largest: teeth meet one after the other."""
_FEWEST_STEPS = 200
"""Rows below which steps are not told from a motion."""
_COUNTS = 2.5
"""Steps of the encoder up to which a step of a slow motion is one of them."""
_BESIDE = 0.2
"""Motion beside a step, over the step, up to which it stands alone."""
_IN_STEPS = 0.7
"""Part of the way that is gone in steps that stand alone."""
_LEAST_PAUSE = 0.12
"""Usual time between two steps [s]; what steps more often is read by a slow drive."""
_MOST_MOVING = 0.3
"""Part of the rows in which a joint that is moved in steps may move; a coarse encoder steps as well, at all times."""
_NO_FRICTION = 0.01
"""Friction over the torque's deviation, below which none shows."""
_BY_ANGLE = 0.98
"""Part of the torque's variance that gravity must explain where no friction shows."""

_SILENT_BLOCK, _SILENT_LAGS = 0.05, 5
"""Time over which a torque is averaged [s], longer than the filter of a sensor colours its noise, and how many such
means apart a torque that is noise alone must not be alike; no joint is driven to and fro faster for long."""
_UNLIKE = 4.0
"""Standard deviations that the correlation of noise with itself does not pass."""
_SILENT = 0.05
"""Part of the torque's variance that the motion may explain of noise alone: five parameters of a short log do."""


class Clamp(NamedTuple):
    """What a drive with a held output shows.

    Attributes:
        stiffness: Of gear, shaft and clamp [N·m/rad] or [N/m].
        gap: Way without torque between both flanks [rad] or [m].
        friction: Half width of the inner friction [as torque].
        residual: Root mean square of what is left of the position [rad] or [m].
        linear_residual: The same with a spring alone.
        stiffening_residual: The same with a spring that stiffens evenly in place of the gap.
    """

    stiffness: float
    gap: float
    friction: float
    residual: float
    linear_residual: float
    stiffening_residual: float = np.inf


def find_one_way(recording: Recording) -> tuple[Finding, ...]:
    """A motion in one direction: friction and a constant torque cannot be told apart in it."""
    step = np.diff(recording.position[:: max(1, len(recording) // _BLOCKS)])
    path = float(np.abs(step).sum())
    if path == 0.0:
        return ()
    back = min(float(step[step > 0.0].sum()), -float(step[step < 0.0].sum()))
    if back > _BACK * path:
        return ()
    message = "the joint moves in one direction only: friction cannot be told from a constant torque"
    if np.ptp(recording.position) >= _AGAIN and recording.metadata.motion == "rotary":
        message += "; what it shows is the sum of both over speed, and what depends on the angle, which comes again"
        return (Finding("one_way_turns", "warning", message, "record both directions", column="position"),)
    message += ", nor from gravity, because no angle comes again; what it shows is the sum of them over speed"
    return (Finding("one_way", "warning", message, "record both directions", column="position"),)


def find_held_output(recording: Recording) -> tuple[Finding, ...]:
    """An output that is held: the position follows the torque, by elasticity and lost motion, and nothing slides."""
    position, torque = np.asarray(recording.position), np.asarray(recording.torque)
    travel = float(np.ptp(position))
    if travel == 0.0 or travel > _HELD_TRAVEL[recording.metadata.motion] or float(np.std(torque)) == 0.0:
        return ()
    if float(np.corrcoef(position, torque)[0, 1]) < _FOLLOWS:
        return ()
    clamp = fit_clamp(recording)
    unit, angle = recording.metadata.torque_unit, recording.metadata.position_unit
    stiffness = f"{clamp.stiffness:.3g} {unit}/{angle}" if np.isfinite(clamp.stiffness) else "not determined"
    message = (
        f"the output is held and the position follows the torque: stiffness {stiffness}, gap "
        f"{1e3 * clamp.gap:.3g} m{angle}, friction inside of ±{clamp.friction:.3g} {unit} that holds it back "
        f"({1e3 * clamp.residual:.2g} m{angle} are left of {1e3 * clamp.linear_residual:.2g} of a spring alone); "
        "nothing slides, so that this shows no friction of sliding"
    )
    return (Finding("held_output", "warning", message, "free the output to identify friction", column="position"),)


def fit_clamp(recording: Recording) -> Clamp:
    """Stiffness, gap and inner friction of a drive whose output is held.

    The torque reaches the spring behind a play operator, whose half width is the friction inside
    [al-bender2004presliding]; the gap is what the position jumps by where the torque changes its sign.
    """
    every = max(1, len(recording) // _CLAMP_ROWS)
    window = np.ones(_CLAMP_MEAN) / _CLAMP_MEAN
    smooth = np.convolve(np.pad(recording.torque, _CLAMP_MEAN // 2, mode="edge"), window, mode="valid")
    torque, position = np.asarray(smooth[::every]), np.asarray(recording.position)[: smooth.size : every]
    top = float(np.abs(torque).max())
    best, linear = Clamp(np.inf, 0.0, 0.0, np.inf, np.inf), 0.0
    for width in np.linspace(0.0, _WIDEST, _WIDTHS) * top:
        passed = _play(torque, float(width))
        for closing in _CLOSING:
            table = np.column_stack([passed, np.tanh(passed / (closing * top)), np.ones(passed.size)])
            compliance, half, offset = np.linalg.lstsq(table, position, rcond=None)[0].tolist()
            left = float(np.std(position - table @ np.array([compliance, half, offset])))
            if left < best.residual and compliance > 0.0:
                best = Clamp(1.0 / compliance, 2.0 * max(half, 0.0), float(width), left, linear)
    passed = _play(torque, best.friction)
    table = np.column_stack([passed, passed**3, np.ones(passed.size)])
    stiffening = float(np.std(position - table @ np.linalg.lstsq(table, position, rcond=None)[0]))
    slope = np.polyfit(torque, position, 1)
    linear = float(np.std(position - np.polyval(slope, torque)))
    return best._replace(linear_residual=linear, stiffening_residual=stiffening)


def _play(values: Samples, width: float) -> Samples:
    """What passes a play of so much to either side. Shape (n,)."""
    passed, at = np.empty(values.size), float(values[0])
    for k, value in enumerate(values.tolist()):
        at = min(max(at, value - width), value + width)
        passed[k] = at
    return passed


def find_steps(recording: Recording) -> tuple[Finding, ...]:
    """A joint that is moved in steps between two rows and rests for the others: the motion itself is not in the log."""
    step = np.abs(np.diff(recording.position))
    path = float(step.sum())
    if path == 0.0 or step.size < _FEWEST_STEPS:
        return ()
    beside = np.maximum(np.concatenate([[0.0], step[:-1]]), np.concatenate([step[1:], [0.0]]))
    alone = (step > _COUNTS * measure_quantum(np.asarray(recording.position))) & (beside < _BESIDE * step)
    if float(step[alone].sum()) < _IN_STEPS * path or np.count_nonzero(alone) > _MOST_MOVING * step.size:
        return ()
    if np.count_nonzero(alone) < 2 or float(np.median(np.diff(recording.time[1:][alone]))) < _LEAST_PAUSE:
        return ()
    message = (
        f"the joint is moved in {np.count_nonzero(alone)} steps, each between two rows, and rests in between: the "
        "motion itself is not in the log; what it shows is the torque that holds the joint over the angle"
    )
    return (Finding("stepped", "warning", message, "record a motion that goes on", column="position"),)


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


def find_silent_torque(recording: Recording) -> tuple[Finding, ...]:
    """A torque that is noise alone while the joint moves: it follows neither itself of a moment ago nor the motion."""
    rows = max(1, round(_SILENT_BLOCK / recording.sample_period))
    means = np.asarray(recording.torque)[: len(recording) // rows * rows].reshape(-1, rows).mean(axis=1)
    torque = means - float(np.mean(means)) if means.size else means
    power = float(torque @ torque)
    fit = fit_joint(recording)
    if fit is None or power == 0.0 or fit.explained > _SILENT or torque.size < _FEWEST_STEPS:
        return ()
    alike = [abs(float(torque[k:] @ torque[:-k])) / power for k in range(1, _SILENT_LAGS + 1)]
    if max(alike) > _UNLIKE / np.sqrt(torque.size):
        return ()
    message = (
        "the torque is noise alone while the joint moves: it follows neither the motion nor itself from one moment to "
        "the next; its drive is off and something else moves the joint, or the column is none of this joint's torque"
    )
    return (Finding("silent_torque", "warning", message, "let the joint's own torque move it", column="torque"),)
