"""The motion that is expected to tell most, among those that limits and contacts allow.

What a motion tells is how far it narrows what was believed before, the simulation's links within their prior:

    I = ½ log det (1 + D Σ_j Y_jᵀ Y_j D / σ_j²)

in natural units of information, with Y the columns of links, rotors and friction, D the deviations of the prior. It is
the D-optimality of the parameters that the motion can show [swevers1997], and needs no choice of those.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray

from ..prior import ArmPrior
from ..rigid.inertia import N_INERTIA
from ..rigid.regressor import compute_regressor
from ..rigid.simulated_arm import SimulatedArm
from .fourier import FourierMotion
from .limits import SPEED_SHARE, ContactCheck, MotionLimits

_HARMONICS = 5
_FREQUENCY = 0.1
"""[Hz] of the first harmonic: five of them reach 0.5 Hz, where arms move fast and do not ring."""

_SAMPLES = 150
"""Samples at which a candidate is judged: several a period of its fastest harmonic over ten of them."""

_CHECKED = 600
"""Samples at which limits and contacts of the chosen motion are checked."""

_DRAWN, _CHANGED = 30, 90
"""Motions that are drawn, and changes of the best one that are tried: the gain of later ones is below a hundredth."""

_SMALLER, _TRIES = 0.85, 12
"""Factor on all swings of a motion that goes too far, and how often it is tried."""

_NOISE = 0.01
"""Deviation of a torque, in its limit, that information is counted in: it scales all motions alike."""

_FRICTION = 0.1
"""Prior deviation of each friction torque, in the torque limit."""


@dataclass(frozen=True)
class Excitation:
    """A motion, and what it is expected to tell.

    Attributes:
        motion: All joints over time.
        information: Expected gain [nat].
        torque: Largest torque of links and rotors, of each joint [N·m] or [N]. Shape (n_joints,).
        speed: Largest speed [rad/s] or [m/s]. Shape (n_joints,).
        notes: What was not looked at, in sentences.
    """

    motion: FourierMotion
    information: float
    torque: FloatArray
    speed: FloatArray
    notes: tuple[str, ...] = ()


def design_excitation(
    arm: SimulatedArm,
    simulation: str | Path,
    limits: MotionLimits,
    *,
    start: FloatArray | None = None,
    duration: float = 60.0,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Excitation:
    """Choose a motion for information within limits.

    Args:
        arm: The joints that move.
        simulation: Its file, for contacts.
        limits: Of the joints, in the order of `arm`.
        start: Where the joints stand [rad] or [m]: the way from there is checked for contacts, too. Shape (n_joints,).
        duration: Of the motion [s]; ten and more.
        seed: Of the motions that are drawn.
        progress: Called with a few words before each step.

    Raises:
        ParameterError: The duration is too short, or no motion fits into the limits without a contact.
    """
    if not 10.0 <= duration <= 600.0:
        raise ParameterError(f"an excitation lasts from 10 to 600 s, got {duration!r}: 60 s tell most arms")
    say, rng = progress or (lambda _: None), np.random.default_rng(seed)
    contacts, judge = ContactCheck(simulation, arm.joints), _Judge(arm, limits)
    best: Excitation | None = None
    say("drawing motions")
    for _ in range(_DRAWN):
        drawn = _fit(_draw(limits, duration, rng), judge, contacts, start)
        if drawn is not None and (best is None or drawn.information > best.information):
            best = drawn
    if best is None:
        raise ParameterError(
            "no motion fits into the limits without a contact: widen the ranges of the joints, or put the arm where it "
            "can move freely"
        )
    say("changing the best one")
    for step in range(_CHANGED):
        other = _fit(_change(best.motion, limits, rng, step / _CHANGED), judge, contacts, start)
        if other is not None and other.information > best.information:
            best = other
    return replace(best, notes=contacts.notes)


def _draw(limits: MotionLimits, duration: float, rng: np.random.Generator) -> FourierMotion:
    n = limits.lowest.size
    sizes = rng.normal(size=(2, n, _HARMONICS)) / np.sqrt(np.arange(1, _HARMONICS + 1))
    middle = 0.5 * (limits.lowest + limits.highest) + 0.3 * limits.swing * rng.uniform(-1.0, 1.0, n)
    return FourierMotion(middle, sizes[0], sizes[1], _FREQUENCY, duration)


def _change(motion: FourierMotion, limits: MotionLimits, rng: np.random.Generator, done: float) -> FourierMotion:
    """The motion with its coefficients moved, by less the later it is."""
    size = 0.5 * (1.0 - done) + 0.05
    spread = size * np.sqrt(np.mean(motion.sine**2 + motion.cosine**2, axis=1))[:, None]
    sine, cosine = (one + spread * rng.normal(size=one.shape) for one in (motion.sine, motion.cosine))
    centre = motion.centre + 0.3 * size * limits.swing * rng.normal(size=motion.centre.size)
    return replace(motion, centre=np.clip(centre, limits.lowest, limits.highest), sine=sine, cosine=cosine)


def _fit(motion: FourierMotion, judge: _Judge, contacts: ContactCheck, start: FloatArray | None) -> Excitation | None:
    """The motion at the size that limits and contacts allow; None where none does."""
    filled = judge.fill(motion)
    if filled is None:
        return None
    motion = filled
    time = np.linspace(0.0, motion.duration, _CHECKED)
    for _ in range(_TRIES):
        position, velocity, acceleration = motion.sample(time)
        torque = judge.compute_torque(position, velocity, acceleration)
        if judge.limits.hold(position, velocity, torque) and not contacts.find(position[:: _CHECKED // _SAMPLES]):
            break
        motion = motion.scaled(_SMALLER)
    else:
        return None
    way = [] if start is None else [start + s * (motion.centre - start) for s in np.linspace(0.0, 1.0, 40)]
    if way and contacts.find(np.array(way)):
        return None
    return Excitation(motion, judge.measure(motion), np.max(np.abs(torque), axis=0), np.max(np.abs(velocity), axis=0))


class _Judge:
    """What motions of an arm take and tell."""

    def __init__(self, arm: SimulatedArm, limits: MotionLimits) -> None:
        self.arm, self.limits = arm, limits
        prior, n = ArmPrior(), len(arm.links)
        slopes = np.zeros((N_INERTIA * n, N_INERTIA * n))
        for i, link in enumerate(arm.link_coordinates):
            at = slice(N_INERTIA * i, N_INERTIA * (i + 1))
            slopes[at, at] = link.jacobian(np.zeros(N_INERTIA)) * prior.links
        self._slopes = slopes

    def fill(self, motion: FourierMotion) -> FourierMotion | None:
        """The motion with the swings of each joint as long as its range and its speed allow."""
        time = np.linspace(0.0, motion.duration, _CHECKED)
        position, velocity, _ = motion.sample(time)
        middle = 0.5 * (self.limits.lowest + self.limits.highest)
        low, high = (position - motion.centre).min(axis=0), (position - motion.centre).max(axis=0)
        centre = np.clip(motion.centre, middle - self.limits.swing, middle + self.limits.swing)
        room = np.minimum(
            (middle + self.limits.swing - centre) / np.maximum(high, 1e-9),
            (centre - middle + self.limits.swing) / np.maximum(-low, 1e-9),
        )
        fast = SPEED_SHARE * self.limits.speed / np.maximum(np.abs(velocity).max(axis=0), 1e-9)
        size = np.minimum(room, fast)
        if np.any(size <= 0.0):
            return None
        return replace(motion, centre=centre, sine=motion.sine * size[:, None], cosine=motion.cosine * size[:, None])

    def compute_torque(self, position: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> FloatArray:
        """Torque of links and rotors at a few of the samples [N·m] or [N]. Shape (n, n_joints)."""
        thin = slice(None, None, _CHECKED // _SAMPLES)
        columns = compute_regressor(self.arm, position[thin], velocity[thin], acceleration[thin])
        return np.asarray(columns @ self.arm.inertia.ravel() + acceleration[thin] * self.arm.armature)

    def measure(self, motion: FourierMotion) -> float:
        """Expected information [nat]."""
        q, v, a = motion.sample(np.linspace(0.0, motion.duration, _SAMPLES))
        links = compute_regressor(self.arm, q, v, a) @ self._slopes
        n, width = v.shape[1], links.shape[2]
        size = width + 4 * n
        H = np.eye(size)
        for j in range(n):
            Y, limit = np.zeros((_SAMPLES, size)), self.limits.torque[j]
            top = max(float(np.abs(v[:, j]).max()), 1e-9)
            own = np.column_stack([np.sign(v[:, j]), np.ones(_SAMPLES), v[:, j] / top, np.abs(v[:, j]) / top])
            Y[:, :width] = links[:, j]
            Y[:, width + 4 * j : width + 4 * j + 4] = _FRICTION * limit * own
            H += Y.T @ Y / (_NOISE * limit) ** 2
        return 0.5 * float(np.linalg.slogdet(H)[1])
