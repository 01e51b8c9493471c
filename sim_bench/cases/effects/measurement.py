"""Effects in what is measured, while the joint is right."""

import numpy as np

from ..dynamics import SAMPLE_PERIOD
from ..effect import Change, Effect, Form, Scene, Truth


def _make_gain(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    signed = amplitude * float(rng.choice([-1.0, 1.0]))
    return Change(sensing={"gain": 1.0 + signed}, parameters={"gain_error": Truth(signed, "1")})


def _make_velocity_lag(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    return Change(sensing={"velocity_lag": amplitude}, parameters={"time_constant": Truth(amplitude, "s")})


def _delay(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    return Change(sensing={"delay": amplitude}, parameters={"delay": Truth(amplitude, "s")})


def _make_eccentricity(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    order, phase = float(rng.choice([1, 2])), rng.uniform(0.0, 2.0 * np.pi)
    return Change(
        plant={"eccentricity": amplitude, "eccentricity_order": order, "eccentricity_phase": phase},
        parameters={
            "sine": Truth(amplitude * np.cos(phase), "rad"),
            "cosine": Truth(amplitude * np.sin(phase), "rad"),
            "order": Truth(order, "1/rev"),
        },
    )


def _make_hysteresis(bouc_wen: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        width = rng.uniform(0.15, 0.4) * scene.load
        sensing = {"hysteresis": amplitude, "hysteresis_width": width, "hysteresis_form": bouc_wen}
        return Change(sensing=sensing, parameters={"share": Truth(amplitude, "1"), "width": Truth(width, "N·m")})

    return Form("Bouc-Wen" if bouc_wen else "play", build, shared=not bouc_wen)


EFFECTS = (
    Effect(
        "torque_gain_error", "measurement", (Form("gain", _make_gain),), lambda scene: (0.01, 0.2), against="friction"
    ),
    Effect(
        "velocity_filter_lag",
        "measurement",
        (Form("first order", _make_velocity_lag),),
        lambda scene: (4e-3, 3e-2),
        smallest=lambda scene: 4e-3,  # every drive filters its velocity by less
    ),
    Effect(
        "torque_delay",
        "measurement",
        (Form("pure", _delay),),
        lambda scene: (1e-3, 1.2e-2),
        localised=True,
        smallest=lambda scene: SAMPLE_PERIOD,  # less is where in its sample a torque belongs
    ),
    Effect("encoder_eccentricity", "measurement", (Form("sine", _make_eccentricity),), lambda scene: (1e-4, 4e-2)),
    Effect(
        "torque_sensor_hysteresis",
        "measurement",
        (_make_hysteresis(0.0), _make_hysteresis(1.0)),
        lambda scene: (0.005, 0.15),
    ),
)
