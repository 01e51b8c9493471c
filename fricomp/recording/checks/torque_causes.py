"""Why a torque seems to take energy out of its joint: each cause is tried before anything is advised.

A rigid joint with friction is fitted to the torque as it is, read as a signed number, moved in time, and turned round.
A cause explains the symptom where the joint that it leaves could exist, and leaves less of the torque unexplained.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.quantum import measure_quantum
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.root_mean_square import compute_rms

__all__ = [
    "BlockMotion",
    "JointFit",
    "Register",
    "average_motion",
    "build_design",
    "explain_energy",
    "find_delay",
    "find_register",
    "find_unsigned_torque",
    "fit_joint",
    "fit_two_torques",
    "read_signed",
]

Samples = NDArray[np.float64]

_BLOCK = 0.02
"""Samples are averaged over so long, or over three of them [s]: encoder steps of an acceleration are then small."""
_SLOW = 0.1
"""Part of the top speed below which the direction of friction is not sure."""
_LONGEST_DELAY = 0.06
"""Largest delay that is tried [s]: two periods of a slow bus and a filter."""
_DELAY_STEP = 2.5e-4
"""Distance of the delays that are tried [s]."""
_CLEARLY = 0.7
"""What a cause may leave of the residual, times what is left without it."""
_EXPLAINED = 0.5
"""Part of the torque's variance that a turned sign must explain."""
_BITS = (8, 12, 14, 16, 24, 32)
"""Lengths of registers."""
_USUAL_BITS = 16
"""Length of most registers of currents."""
_WHOLE_RANGE = 0.02
"""Relative distance of a jump from the range of a register: the torque itself moves on meanwhile."""
_WHOLE_JUMP = 0.8
"""Part of the largest torque from which on a jump is a whole one; interpolation makes two of one."""
_BETWEEN = 0.05
"""Part of the rows that may lie between both ends of the range: interpolation puts them there."""
_SURE = 3.0
"""Standard deviations beyond which a negative inertia is one."""
_ALIKE = 5.0
"""Blocks that err alike: their variance counts so often."""
_ALIKE_ROWS = 3
"""Rows that are averaged where two torques are compared."""
_CERTAIN = 4.0
"""Standard deviations from a gain of one, or from no saturation, beyond which it is told."""
_MATTERS = 0.03
"""Relative error of a torque that matters."""
_OF_THE_REST = 0.5
"""What a saturation explains of the load torque over what is left of it: less may be what the law of friction lacks."""
_STEEPER = 5.0
"""Between the widths of the two changes of direction that stand for friction near zero speed."""
_RELATED = 0.8
"""Correlation of two torques below which one is not that of the other's joint."""
_APART = 0.1
"""Part of a column that no other one holds, below which its parameter is not determined."""


@dataclass(frozen=True)
class JointFit:
    """torque = inertia a + viscous v + coulomb sgn(v) + offset + gravity, by least squares.

    Attributes:
        inertia: [kg·m²] or [kg].
        viscous: [N·m·s/rad] or [N·s/m].
        coulomb: [N·m] or [N].
        deviations: Of these three.
        residual: Root mean square of what is left [N·m] or [N].
        explained: Part of the torque's variance that is explained.
        friction: Mean torque of friction at the speeds that occur [N·m] or [N].
    """

    inertia: float
    viscous: float
    coulomb: float
    deviations: tuple[float, float, float]
    residual: float
    explained: float
    friction: float

    @property
    def can_be(self) -> bool:
        """Whether a joint could have this inertia and this friction."""
        return self.friction > 0.0 and self.inertia > -_SURE * self.deviations[0]


class Register(NamedTuple):
    """What a signed torque was stored in.

    Attributes:
        bits: Its length.
        span: Its range [as torque].
        sure: Whether the steps of the torque tell the length.
    """

    bits: int
    span: float
    sure: bool


class TwoTorques(NamedTuple):
    """load torque = gain * torque, or = (small_gain + bend * torque²) * torque, beside inertia, friction and offset.

    Attributes:
        gain: [1]
        gain_deviation: Its standard deviation, for blocks that err alike [1].
        small_gain: Gain at small torques [1].
        small_gain_deviation: Its standard deviation [1].
        bend: Change of the gain with the square of the torque [1 / torque²].
        bend_deviation: Its standard deviation.
        largest: Largest torque that occurs for long [as torque].
        unexplained: What is left, over the deviation of the load torque.
        straight_unexplained: The same without the bend.
    """

    gain: float
    gain_deviation: float
    small_gain: float
    small_gain_deviation: float
    bend: float
    bend_deviation: float
    largest: float
    unexplained: float
    straight_unexplained: float

    @property
    def loss(self) -> float:
        """Part of the torque that is lost at the largest one."""
        return -self.bend * self.largest**2 / self.small_gain if self.small_gain > 0.0 else 0.0

    @property
    def saturates(self) -> bool:
        """Whether a loss at large torques is sure, matters, and explains more than the law of friction may leave."""
        bent = self.straight_unexplained**2 - self.unexplained**2
        return (
            self.bend < -_CERTAIN * self.bend_deviation
            and self.loss > max(_MATTERS, self.unexplained)
            and bent > (_OF_THE_REST * self.unexplained) ** 2
        )

    @property
    def told_gain(self) -> tuple[float, float]:
        """The gain, at small torques where the motor saturates, and its standard deviation."""
        small = self.small_gain, self.small_gain_deviation
        return small if self.saturates else (self.gain, self.gain_deviation)

    @property
    def is_off(self) -> bool:
        """Whether this gain is not one: a smaller error may be a part of what friction leaves of the load torque."""
        gain, deviation = self.told_gain
        return abs(gain - 1.0) > max(_CERTAIN * deviation, _MATTERS, self.unexplained)


class BlockMotion(NamedTuple):
    """Block means of a motion; rows are those that slide and have both neighbours."""

    time: Samples
    position: Samples
    velocity: Samples
    acceleration: Samples
    rows: NDArray[np.bool_]
    width: int

    def average_all(self, values: Samples) -> Samples:
        """Means of samples over all blocks. Shape (n_blocks,)."""
        return np.asarray(values[: self.time.size * self.width].reshape(-1, self.width).mean(axis=1))

    def average(self, values: Samples) -> Samples:
        """Means of samples over the blocks that slide. Shape (n_rows,)."""
        return self.average_all(values)[self.rows]


def fit_joint(recording: Recording, torque: Samples | None = None, delay: float = 0.0) -> JointFit | None:
    """Fit a rigid joint with friction; None where the motion is too short, or goes one way only.

    Args:
        recording: Of one joint.
        torque: In place of the recorded one [as torque].
        delay: How long after its stamp the torque acts [s].
    """
    motion = average_motion(recording)
    return (
        None
        if motion is None
        else _fit(motion, recording, np.asarray(recording.torque if torque is None else torque), delay)
    )


def fit_two_torques(recording: Recording) -> TwoTorques | None:
    """Compare the motor's torque with that of a sensor; None where there is none, or both are hardly related."""
    if recording.load_torque is None or len(recording) < 60 * _ALIKE_ROWS:
        return None
    count = len(recording) // _ALIKE_ROWS * _ALIKE_ROWS
    time, position, torque, load = (
        np.asarray(values)[:count].reshape(-1, _ALIKE_ROWS).mean(axis=1)
        for values in (recording.time, recording.position, recording.torque, recording.load_torque)
    )
    velocity = np.gradient(position, time)
    slow = float(np.percentile(np.abs(velocity), 98)) * _SLOW
    slow = max(slow, 1e-300)
    friction = [np.tanh(velocity / slow), np.tanh(_STEEPER * velocity / slow), velocity, velocity * np.abs(velocity)]
    beside = [np.gradient(velocity, time), *friction, np.ones(time.size)]
    size = float(np.std(load))
    if float(np.std(torque)) == 0.0 or size == 0.0 or abs(np.corrcoef(torque, load)[0, 1]) < _RELATED:
        return None
    gain, gain_deviation, straight = _solve_first(np.column_stack([torque, *beside]), load, 1)
    solved, deviations, left = _solve_first(np.column_stack([torque, torque**3, *beside]), load, 2)
    largest = float(np.quantile(np.abs(torque), 0.99))
    return TwoTorques(
        float(gain[0]), float(gain_deviation[0]), float(solved[0]), float(deviations[0]), float(solved[1]),
        float(deviations[1]), largest, left / size, straight / size,
    )  # fmt: skip


def _solve_first(table: Samples, target: Samples, count: int) -> tuple[Samples, Samples, float]:
    """The first parameters by least squares, their standard deviations, and what is left."""
    solution = np.asarray(np.linalg.lstsq(table, target, rcond=None)[0], dtype=np.float64)
    left = float(np.std(target - table @ solution))
    spread = left * np.sqrt(_ALIKE * np.diag(np.linalg.pinv(table.T @ table)))
    return solution[:count], spread[:count], left


def explain_energy(recording: Recording, symptom: str) -> Finding:
    """Say why the torque takes energy out of the joint, with the line to write where one cause explains it.

    Args:
        recording: Its torque takes energy out of the joint.
        symptom: What was seen, in words.
    """
    unsigned = find_unsigned_torque(recording)
    if unsigned:
        return unsigned[0]
    delay = find_delay(recording)
    if delay is not None:
        message = f"{symptom}, because it acts {1e3 * delay:.3g} ms after its stamp"
        advice = (
            f"identification and diagnosis take that off; for other tools write delay = {delay:.4g} into the channel "
            "of a mapping"
        )
        return Finding("late_torque", "warning", message, advice, column="torque")
    turned = fit_joint(recording, -np.asarray(recording.torque))
    if turned is None or (turned.can_be and turned.explained > _EXPLAINED):
        advice = "flip its sign (sign = -1 in a mapping): positive torque accelerates towards positive position"
        return Finding("flipped_torque", "error", symptom, advice, column="torque")
    message = f"{symptom}, and neither another sign nor a delay explains it: something else moves the joint"
    advice = (
        "record it while its neighbours rest and nobody moves it by hand, or give the arm's simulation and all joints"
    )
    return Finding("driven", "error", message, advice, column="torque")


def find_unsigned_torque(recording: Recording) -> tuple[Finding, ...]:
    """A signed torque that was read as an unsigned number: it jumps by the whole range of its register."""
    register = find_register(recording)
    if register is None:
        return ()
    unit = recording.metadata.torque_unit
    message = (
        f"torque jumps by {register.span:.5g} {unit} and back, the range of a register: it is a signed number of "
        f"{register.bits} bits that was read as an unsigned one"
    )
    if not register.sure:
        message += " (16 where its steps do not tell the length; see the manual)"
    advice = (
        f"write signed_bits = {register.bits} into the channel of a mapping where its column holds the counts, or "
        f"signed_range = {register.span:.6g} [{unit}] where they are scaled ('fricomp convert LOG --inspect' has a "
        "mapping to edit)"
    )
    return (Finding("unsigned_torque", "error", message, advice, column="torque"),)


def find_register(recording: Recording) -> Register | None:
    """The register of a signed torque that was read as an unsigned number; None where it was not.

    Its values lie next to zero and next to the range of the register, nowhere between, and never further apart than the
    range: kicks of a controller do. Where the range is no power of two of the torque's steps, a torque in pulses looks
    alike: then only the motion tells.
    """
    torque = np.asarray(recording.torque)
    torque = -torque if torque.max() < -torque.min() else torque
    jumps = np.abs(np.diff(torque))
    if not np.any(jumps > 0.5 * float(np.ptp(torque))):
        return None
    whole = jumps[jumps > _WHOLE_JUMP * torque.max()]
    span = float(np.median(whole) if whole.size else torque.max())
    low = np.abs(torque) < 0.25 * span
    between = float(np.mean(~low & (np.abs(torque - span) >= 0.25 * span)))
    quantum = measure_quantum(torque[low]) if np.count_nonzero(low) > 1 else 0.0
    if between > _BETWEEN:
        return None
    sign = 1.0 if recording.torque.max() >= -recording.torque.min() else -1.0
    as_it_is = fit_joint(recording)
    bits = round(np.log2(span / quantum)) if quantum > 0.0 else 0
    if bits in _BITS and abs(span / (quantum * 2.0**bits) - 1.0) < _WHOLE_RANGE:
        span = quantum * 2.0**bits
        as_signed = fit_joint(recording, sign * read_signed(torque, span))
        plain = as_it_is and as_signed and as_it_is.can_be and as_it_is.residual < as_signed.residual
        return None if plain or float(np.ptp(torque)) > span else Register(bits, span, sure=True)
    as_signed = fit_joint(recording, sign * read_signed(torque, span))
    if as_it_is is None or as_signed is None or as_it_is.can_be or not as_signed.can_be:
        return None
    return Register(_USUAL_BITS, span, sure=False)


def read_signed(values: Samples, span: float) -> Samples:
    """Unsigned readings of a register of the range `span` as signed ones."""
    return np.where(values >= 0.5 * span, values - span, values)


def find_delay(recording: Recording) -> float | None:
    """How long after its stamp the torque acts [s]; None where no delay makes a joint of it that could exist."""
    motion, torque = average_motion(recording), np.asarray(recording.torque)
    if motion is None:
        return None
    at_once = _fit(motion, recording, torque, 0.0)
    step = max(_DELAY_STEP, 0.1 * recording.sample_period)
    tried = np.arange(step, _LONGEST_DELAY, step)
    fits = [_fit(motion, recording, torque, float(delay)) for delay in tried]
    left = np.array([np.inf if fit is None else fit.residual for fit in fits])
    best = int(np.argmin(left))
    found = fits[best]
    if found is None or at_once is None or best == tried.size - 1 or not found.can_be or found.inertia <= 0.0:
        return None
    if found.residual > _CLEARLY * at_once.residual:
        return None
    return float(tried[best])


def average_motion(recording: Recording) -> BlockMotion | None:
    """Average a recorded motion over blocks; None where it is too short, or goes one way only."""
    width = max(3, round(_BLOCK / recording.sample_period))
    count = len(recording) // width * width
    if count < 60 * width:
        return None
    time, position = (
        np.asarray(values)[:count].reshape(-1, width).mean(axis=1) for values in (recording.time, recording.position)
    )
    velocity = np.gradient(position, time)
    acceleration = np.gradient(velocity, time)
    top = float(np.percentile(np.abs(velocity), 98))
    direction = np.sign(velocity) * (np.abs(velocity) > _SLOW * top)
    rows = direction != 0.0
    for shift in (1, 2):
        rows[shift:] &= direction[shift:] == direction[:-shift]
        rows[:-shift] &= direction[:-shift] == direction[shift:]
    gaps = np.concatenate([[0.0], np.diff(time)]) > 3.0 * float(np.median(np.diff(time)))
    for shift in (-2, -1, 0, 1, 2):
        rows &= ~np.roll(gaps, shift)
    rows[:2] = rows[-2:] = False
    if min(np.sum(velocity[rows] > 0.0), np.sum(velocity[rows] < 0.0)) < 10:
        return None
    return BlockMotion(time, position, velocity, acceleration, rows, width)


def build_design(motion: BlockMotion, *, rotary: bool) -> Samples:
    """Build what inertia, viscous and Coulomb friction, offset and gravity each add to a torque. Shape (n_rows, 5 or
    6)."""
    v, a, q = (each[motion.rows] for each in (motion.velocity, motion.acceleration, motion.position))
    held = [np.sin(q), np.cos(q)] if rotary else [q]
    return np.column_stack([a, v, np.sign(v), np.ones(v.size), *held])


def _fit(motion: BlockMotion, recording: Recording, torque: Samples, delay: float) -> JointFit | None:
    if delay != 0.0:
        torque = np.interp(np.asarray(recording.time) - delay, recording.time, torque)
    target = motion.average(torque)
    v, design = motion.velocity[motion.rows], build_design(motion, rotary=recording.metadata.motion == "rotary")
    scale = np.maximum(np.abs(design).max(axis=0), 1e-300)
    q_part, r_part = np.linalg.qr(design / scale)
    if np.abs(np.diag(r_part)).min() < 1e-9 * np.abs(np.diag(r_part)).max():
        inverse = np.linalg.pinv(r_part)
    else:
        inverse = np.linalg.inv(r_part)
    solution = inverse @ (q_part.T @ target)
    left = target - design / scale @ solution
    residual = compute_rms(left)
    size = np.sqrt(np.sum(inverse**2, axis=1))
    spread = residual * np.sqrt(_ALIKE) * size
    alone = 1.0 / np.maximum(size, 1e-300) / np.maximum(np.linalg.norm(design / scale, axis=0), 1e-300)
    spread[alone < _APART] = np.inf  # another column can take its place, such as gravity that of inertia in one swing
    inertia, viscous, coulomb = (solution / scale)[:3].tolist()
    variance = float(np.var(target))
    mean = coulomb + viscous * float(np.mean(np.abs(v)))
    return JointFit(
        inertia, viscous, coulomb, tuple((spread / scale)[:3].tolist()), residual,
        1.0 - residual**2 / variance if variance > 0.0 else 0.0, mean,
    )  # fmt: skip
