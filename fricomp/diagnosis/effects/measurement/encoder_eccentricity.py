"""An encoder disc that is mounted off its centre."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...joint.kernel import compile_kernel
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..overtones import get_overtone, list_multiples

_ROUNDS = 4
"""Number of rounds towards the position at which the error is made: a small angle converges in fewer."""


@compile_kernel
def _trace_to_source(
    wave: tuple[np.ndarray, np.ndarray], position: tuple[np.ndarray, np.ndarray], order: float, sizes: np.ndarray
) -> np.ndarray:
    """The encoder's error e(q) at the position at which it is made, for the recorded one.

    The error is a small angle, so that sums of angles take the place of sines at every round.

    Args:
        wave: Cosine and sine of n times the recorded position. Shapes (n_samples,).
        position: Cosine and sine of the recorded position. Shapes (n_samples,).
        order: n.
        sizes: Amplitudes of sine and cosine at once, twice and three times that order [rad]. Shape (<= 3, 2).

    Returns:
        Slope and curvature of e over the position, and cosine and sine of that position. Shape (4, n_samples).
    """
    (wave_cosine, wave_sine), (position_cosine, position_sine) = wave, position
    out = np.empty((4, wave_cosine.size))
    for k in range(wave_cosine.size):
        c, s = wave_cosine[k], wave_sine[k]
        last = error = _add_waves(c, s, sizes)[0]
        for _ in range(_ROUNDS):
            turned_cosine, turned_sine = _expand_small_angle(order * error)
            last = error
            c = wave_cosine[k] * turned_cosine + wave_sine[k] * turned_sine
            s = wave_sine[k] * turned_cosine - wave_cosine[k] * turned_sine
            error = _add_waves(c, s, sizes)[0]
        turned_cosine, turned_sine = _expand_small_angle(last)
        _, slope, curvature = _add_waves(c, s, sizes)
        out[0, k], out[1, k] = order * slope, order * order * curvature
        out[2, k] = position_cosine[k] * turned_cosine + position_sine[k] * turned_sine
        out[3, k] = position_sine[k] * turned_cosine - position_cosine[k] * turned_sine
    return out


@compile_kernel
def _add_waves(c: float, s: float, sizes: np.ndarray) -> tuple[float, float, float]:
    """The error at an angle with this cosine and sine [rad], and its first two derivatives by that angle."""
    error = slope = curvature = 0.0
    cosine, sine = c, s
    for k in range(sizes.shape[0]):
        here, ahead = sizes[k, 0] * sine + sizes[k, 1] * cosine, sizes[k, 0] * cosine - sizes[k, 1] * sine
        error, slope, curvature = error + here, slope + (k + 1) * ahead, curvature - (k + 1) ** 2 * here
        cosine, sine = cosine * c - sine * s, sine * c + cosine * s
    return error, slope, curvature


@compile_kernel
def _expand_small_angle(x: float) -> tuple[float, float]:
    """Cosine and sine, to 1e-15 up to 0.3 rad."""
    z = x * x
    # Taylor series up to the eleventh power of the sine and the twelfth of the cosine, by Horner's rule.
    sine = 1.0 - z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0 * (1.0 - z / 110.0))))
    cosine = 1.0 - z / 2.0 * (  # likewise
        1.0 - z / 12.0 * (1.0 - z / 30.0 * (1.0 - z / 56.0 * (1.0 - z / 90.0 * (1.0 - z / 132.0))))
    )
    return cosine, x * sine


@register
class EncoderEccentricity(Effect):
    """q_recorded = q + A sin(n q + phi), n = 1 or 2."""

    name = "encoder_eccentricity"
    kind = "measurement"
    equation = "q_recorded = q + A sin(n q + phi)"
    citation = ""
    says = "the encoder reads once or twice per turn wrong"
    ripple = True
    misreads_position = True
    usual_error: ClassVar[float] = 1e-3
    """Error that matters [rad]: discs of encoders are off by that much and more."""
    largest_error: ClassVar[float] = 0.1
    """Largest error [rad]; no mount lets a disc be so far off its centre."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        size, most = self.usual_error, self.largest_error
        wave = tuple(EffectParameter(n, "{position}", size, -most, most) for n in ("sine", "cosine"))
        return (*wave, EffectParameter("order", "1/rev", 0.0, 1.0, 2.0, linear=False))

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"order": 1.0}, {"order": 2.0}]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        order, sizes = values["order"], np.zeros((list_multiples(values)[-1], 2))
        for times in list_multiples(values):
            sizes[times - 1] = get_overtone(values, times)
        usual = context.waves
        waves = usual if order == 1.0 else (np.cos(order * context.position), np.sin(order * context.position))
        slope, curvature, cosine_there, sine_there = _trace_to_source(waves, usual, order, sizes)
        v = context.velocity / (1.0 + slope)
        a = (context.acceleration - curvature * v**2) / (1.0 + slope)
        plant = context.plant
        gravity = plant.compute_static_torque(cosine_there, sine_there) - plant.compute_static_torque(*context.waves)
        viscous = np.where(v >= 0.0, plant.forward[3], plant.reverse[3])
        return Contribution(
            additive=gravity + plant.inertia * (a - context.acceleration) + viscous * (v - context.velocity)
        )

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return (
            "no disc is so far off its centre"
            if np.hypot(values["sine"], values["cosine"]) > self.largest_error
            else None
        )

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        return None if contexts[0].rotary else "the joint is linear"
