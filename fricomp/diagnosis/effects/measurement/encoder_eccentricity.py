"""An encoder disc that is mounted off its centre."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...joint.kernel import compile_kernel
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register

_ROUNDS = 4
"""Number of rounds towards the position at which the error is made: a small angle converges in fewer."""


@compile_kernel
def _trace_to_source(
    wave: tuple[np.ndarray, np.ndarray], position: tuple[np.ndarray, np.ndarray], settings: np.ndarray
) -> np.ndarray:
    """The encoder's error e(q) at the position at which it is made, for the recorded one.

    The error is a small angle, so that sums of angles take the place of sines at every round.

    Args:
        wave: Cosine and sine of n times the recorded position. Shapes (n_samples,).
        position: Cosine and sine of the recorded position. Shapes (n_samples,).
        settings: Amplitudes of sine and cosine [rad], and the order n.

    Returns:
        e [rad], its slope over the position, and cosine and sine of that position. Shape (4, n_samples).
    """
    sine, cosine, order = settings
    (wave_cosine, wave_sine), (position_cosine, position_sine) = wave, position
    out = np.empty((4, wave_cosine.size))
    for k in range(wave_cosine.size):
        c, s = wave_cosine[k], wave_sine[k]
        last = error = sine * s + cosine * c
        for _ in range(_ROUNDS):
            turned_cosine, turned_sine = _expand_small_angle(order * error)
            last = error
            c = wave_cosine[k] * turned_cosine + wave_sine[k] * turned_sine
            s = wave_sine[k] * turned_cosine - wave_cosine[k] * turned_sine
            error = sine * s + cosine * c
        turned_cosine, turned_sine = _expand_small_angle(last)
        out[0, k], out[1, k] = error, order * (sine * c - cosine * s)
        out[2, k] = position_cosine[k] * turned_cosine + position_sine[k] * turned_sine
        out[3, k] = position_sine[k] * turned_cosine - position_cosine[k] * turned_sine
    return out


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
        sine, cosine, order = values["sine"], values["cosine"], values["order"]
        usual = context.waves
        waves = usual if order == 1.0 else (np.cos(order * context.position), np.sin(order * context.position))
        wave, slope, cosine_there, sine_there = _trace_to_source(waves, usual, np.array([sine, cosine, order]))
        v = context.velocity / (1.0 + slope)
        a = (context.acceleration + order**2 * wave * v**2) / (1.0 + slope)
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
