"""Motions that a case is recorded on: position and velocity references at 1 kHz, smooth in acceleration."""

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from .dynamics import SAMPLE_PERIOD

Samples = NDArray[np.float64]

_QUIET = 0.7  # [s] at rest at the beginning of the recording
LEAD_IN = 1.5  # [s] at rest before the recording starts, so that it starts from an ordinary state
_SMOOTHING = 0.04  # [s] of each of two moving averages


def build_reference(kind: str, duration: float, speed: float, rng: np.random.Generator) -> Samples:
    """Position [rad] and velocity [rad/s] references after a lead-in at rest, shape (n_samples, 2).

    The recording starts at rest too: the first breakaway belongs to it, with what came before it in sight.

    Args:
        kind: Key of `EXCITATIONS`.
        duration: Of the recording [s]; the motion fills it.
        speed: Largest speed [rad/s].
        rng: Draws range, order and phases.
    """
    n, quiet = round(duration / SAMPLE_PERIOD), round(_QUIET / SAMPLE_PERIOD)
    velocity = np.concatenate([np.zeros(quiet), EXCITATIONS[kind](duration, speed, rng)])
    lead = round(LEAD_IN / SAMPLE_PERIOD)
    padded = np.zeros(lead + n)
    usable = min(n, velocity.size)
    padded[lead : lead + usable] = velocity[:usable]
    smooth = _smooth(padded)
    position = np.cumsum(smooth) * SAMPLE_PERIOD
    return np.stack([position + rng.uniform(-0.4, 0.4) - 0.5 * (position.max() + position.min()), smooth], axis=1)


def settle(reference: Samples) -> Samples:
    """A reference with the lead-in at rest before it; shape (n_samples, 2) to (n_samples + lead-in, 2)."""
    lead = np.zeros((round(LEAD_IN / SAMPLE_PERIOD), 2))
    lead[:, 0] = reference[0, 0]
    return np.concatenate([lead, reference])


def _smooth(values: Samples) -> Samples:
    width = round(_SMOOTHING / SAMPLE_PERIOD)
    kernel = np.ones(width) / width
    for _ in range(2):
        values = np.convolve(np.pad(values, width, mode="edge"), kernel, mode="same")[width:-width]
    return values


def _make_rest(seconds: float) -> Samples:
    return np.zeros(round(seconds / SAMPLE_PERIOD))


def _make_stroke(distance: float, speed: float, acceleration: float = 8.0) -> Samples:
    """Velocity of a trapezoidal move over `distance` [rad], signed, never faster than `speed`."""
    length = abs(distance)
    top = min(speed, np.sqrt(length * acceleration))
    ramp, hold = top / acceleration, length / top - top / acceleration
    t = np.arange(0.0, hold + 2.0 * ramp, SAMPLE_PERIOD)
    profile = np.minimum(np.minimum(acceleration * t, top), acceleration * (hold + 2.0 * ramp - t))
    area = profile.sum() * SAMPLE_PERIOD
    return np.asarray(np.sign(distance) * profile * (length / area))


def _make_shuttle(speeds: Iterable[float], span: float, longest: float) -> Samples:
    """Forth and back once at each speed, over `span` [rad] or as far as `longest` [s] allows."""
    moves = []
    for speed in speeds:
        distance = min(span, speed * longest)
        moves += [_make_stroke(distance, speed), _make_stroke(-distance, speed)]
    return np.concatenate(moves)


def _make_multisine(duration: float, speed: float, span: float, rng: np.random.Generator) -> Samples:
    """Five harmonics of 0.1 Hz, starting and ending at rest at the same place."""
    t = np.arange(0.0, duration, SAMPLE_PERIOD)
    orders, phases = np.arange(1, 6), rng.uniform(0.0, 2.0 * np.pi, 5)
    amplitudes = rng.uniform(0.4, 1.0, 5) / orders**0.5
    waves = np.sin(2.0 * np.pi * 0.1 * np.outer(orders, t) + phases[:, None])
    position = amplitudes @ waves
    window = np.clip(np.minimum(t, duration - t) / 1.5, 0.0, 1.0)
    position = position * np.sin(0.5 * np.pi * window) ** 2
    velocity = np.gradient(position, SAMPLE_PERIOD)
    scale = min(speed / np.abs(velocity).max(), 0.5 * span / np.abs(position).max())
    return np.asarray(velocity * scale)


def _make_chirp(duration: float, speed: float, span: float, top: float = 8.0) -> Samples:
    """A chirp from 0.1 Hz to `top` [Hz] whose amplitude falls with frequency."""
    t = np.arange(0.0, duration, SAMPLE_PERIOD)
    frequency = 0.1 * (top / 0.1) ** (t / duration)
    phase = 2.0 * np.pi * np.cumsum(frequency) * SAMPLE_PERIOD
    pulse = 2.0 * np.pi * frequency
    amplitude = np.minimum(np.minimum(0.4 * span, 0.6 * speed / pulse), 30.0 / pulse**2)
    window = np.clip(np.minimum(t, duration - t) / 0.5, 0.0, 1.0)
    return np.asarray(np.gradient(amplitude * np.sin(phase) * window, SAMPLE_PERIOD))


def _make_small_reversals(seconds: float, rng: np.random.Generator) -> Samples:
    """Nested loops of 2 to 60 mrad, slow."""
    t = np.arange(0.0, seconds, SAMPLE_PERIOD)
    envelope = np.geomspace(0.06, 0.002, t.size)
    position = envelope * (np.sin(2 * np.pi * 0.4 * t) + 0.35 * np.sin(2 * np.pi * 1.1 * t + rng.uniform(0, 6.28)))
    window = np.clip(np.minimum(t, seconds - t) / 0.3, 0.0, 1.0)
    return np.asarray(np.gradient(position * window, SAMPLE_PERIOD))


def _repeat(piece: Callable[[], Samples], duration: float) -> Samples:
    pieces: list[Samples] = []
    while sum(p.size for p in pieces) < duration / SAMPLE_PERIOD:
        pieces.append(piece())
    return np.concatenate(pieces)


def _make_sweep(duration: float, speed: float, rng: np.random.Generator) -> Samples:
    """A staircase of constant speeds forth and back, log-spaced from 1 % of the top speed."""
    span, count = rng.uniform(1.6, 2.6), max(4, round(duration / 8.0))
    speeds = np.geomspace(0.012 * speed, speed, count)
    once = _make_shuttle(speeds, span, longest=0.25 * duration / count * 1.4)
    return _repeat(
        lambda: np.concatenate([once, _make_rest(0.5), _make_shuttle(speeds[count // 2 :], span, 2.0)]), duration
    )


def _make_fourier(duration: float, speed: float, rng: np.random.Generator) -> Samples:
    return _make_multisine(duration, speed, rng.uniform(1.8, 2.8), rng)


def _make_slow_reversals(duration: float, speed: float, rng: np.random.Generator) -> Samples:
    """One-directional strokes at slow speeds between reversals of different depth, a dozen of them at least."""
    depths, longest = rng.permutation(np.geomspace(0.02, 1.2, 7)), duration / 12.0
    slow = np.geomspace(0.02, 0.25, 7) * speed

    def piece() -> Samples:
        pairs = [(min(d, v * longest), v) for d, v in zip(depths, rng.permutation(slow), strict=True)]
        moves = [move for d, v in pairs for move in (_make_stroke(d, v), _make_stroke(-d, v))]
        return np.concatenate([*moves, _make_rest(0.4)])

    return _repeat(piece, duration)


def _make_chirps(duration: float, speed: float, rng: np.random.Generator) -> Samples:
    span = rng.uniform(1.2, 2.0)
    return np.concatenate([_make_chirp(0.5 * duration, speed, span), _make_chirp(0.5 * duration, speed, span, 12.0)])


def _make_rich(duration: float, speed: float, rng: np.random.Generator) -> Samples:
    """Speeds from 1 % up, rests of 0.1 to 3 s, a multisine, nested reversals and a chirp."""
    span = rng.uniform(2.0, 3.2)
    speeds = np.geomspace(0.012, 1.0, 9) * speed
    rests = (0.1, 0.3, 1.0, 3.0)
    shuttle = _make_shuttle(speeds, span, longest=0.018 * duration)
    nudge = _make_stroke(0.15, 0.3)
    waits = np.concatenate([np.concatenate([_make_rest(r), nudge, _make_rest(r), -nudge]) for r in rests])
    used = (shuttle.size + waits.size) * SAMPLE_PERIOD
    left = max(duration - used, 0.25 * duration)
    parts = [shuttle, waits, _make_multisine(0.5 * left, speed, span, rng), _make_small_reversals(0.2 * left, rng)]
    return np.concatenate([*parts, _make_chirp(0.3 * left, speed, span)])


def _make_pick_and_place(duration: float, speed: float, rng: np.random.Generator) -> Samples:
    """Moves between five poses with waits, as in production."""
    poses = np.sort(rng.uniform(-1.2, 1.2, 5))

    def piece() -> Samples:
        order = rng.permutation(poses)
        steps = np.diff(np.concatenate([[0.0], order, [0.0]]))
        moves = [
            m
            for d in steps
            for m in (_make_stroke(d, speed * rng.uniform(0.3, 1.0)), _make_rest(rng.uniform(0.2, 0.9)))
        ]
        return np.concatenate(moves)

    return _repeat(piece, duration)


EXCITATIONS: dict[str, Callable[[float, float, np.random.Generator], Samples]] = {
    "sweep": _make_sweep,
    "fourier": _make_fourier,
    "slow_reversals": _make_slow_reversals,
    "chirp": _make_chirps,
    "rich": _make_rich,
    "pick_and_place": _make_pick_and_place,
}
