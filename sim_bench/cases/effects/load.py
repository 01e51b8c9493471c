"""Friction that follows the transmitted load."""

import numpy as np

from ..effect import Change, Effect, Form, Scene, Truth

_PER_LOAD = "N·m/N·m"


def _make_coulomb(smoothing: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        plant = {"load_coulomb": amplitude, "load_smoothing": smoothing * scene.gravity}
        return Change(plant=plant, parameters={"coefficient": Truth(amplitude, _PER_LOAD)})

    return Form("rounded" if smoothing else "linear", build, shared=not smoothing)


def _make_stribeck(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    return Change(plant={"load_stribeck": amplitude}, parameters={"coefficient": Truth(amplitude, _PER_LOAD)})


def _make_quadratic(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    coefficient = amplitude / scene.load
    return Change(plant={"load_quadratic": coefficient}, parameters={"coefficient": Truth(coefficient, "1/(N·m)")})


def _make_braking(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    return Change(plant={"load_braking": amplitude}, parameters={"driving_coefficient": Truth(amplitude, _PER_LOAD)})


EFFECTS = (
    Effect("load_coulomb", "physics", (_make_coulomb(0.0), _make_coulomb(0.15)), lambda scene: (0.02, 0.35)),
    Effect("load_stribeck", "physics", (Form("linear", _make_stribeck),), lambda scene: (0.03, 0.6), localised=True),
    Effect(
        "load_quadratic",
        "physics",
        (Form("quadratic", _make_quadratic), Form("driving", _make_braking)),
        lambda scene: (0.02, 0.4),
    ),
)
