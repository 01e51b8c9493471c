"""Effects of the gear between motor and link, and of the joint next door."""

import numpy as np

from ..effect import Change, Effect, Form, Scene, Truth


def _make_kinematic(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    order, phase = 2.0 * scene.joint.gear_ratio, rng.uniform(0.0, 2.0 * np.pi)
    return Change(
        plant={"kinematic": amplitude, "kinematic_order": order, "kinematic_phase": phase},
        parameters={"amplitude": Truth(amplitude, "rad"), "order": Truth(order, "1/rev")},
    )


def _make_elastic(hardening: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        stiffness = 1.0 / amplitude
        damping = 0.03 * 2.0 * np.sqrt(stiffness * scene.inertia)
        plant = {
            "flexible": 1.0,
            "stiffness": stiffness,
            "spring_damping": damping,
            "hardening": hardening / scene.load**2,
        }
        return Change(plant=plant, parameters={"stiffness": Truth(stiffness, "N·m/rad")})

    return Form("cubic" if hardening else "linear", build, shared=not hardening)


def _make_backlash(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    stiffness = 400.0**2 * scene.inertia * rng.uniform(1.0, 2.0)
    damping = 0.15 * 2.0 * np.sqrt(stiffness * scene.inertia)
    return Change(
        plant={"flexible": 1.0, "stiffness": stiffness, "spring_damping": damping, "gap": amplitude},
        parameters={"gap": Truth(amplitude, "rad")},
    )


def _make_neighbour(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    t = scene.time
    w, phase = 2.0 * np.pi * rng.uniform(0.2, 0.4, 2), rng.uniform(0.0, 6.28, 2)
    window = np.clip(t / 2.0, 0.0, 1.0)
    q = window * (0.6 * np.sin(w[0] * t + phase[0]) + 0.35 * np.sin(2.7 * w[1] * t + phase[1]))
    v = np.gradient(q, t)
    a = np.gradient(v, t)
    centrifugal = amplitude * rng.uniform(0.3, 1.0)
    return Change(
        disturbance=amplitude * a * np.cos(q) + centrifugal * v**2 * np.sin(q),
        parameters={"coupling_inertia": Truth(amplitude, "kg·m²"), "centrifugal": Truth(centrifugal, "kg·m²")},
    )


EFFECTS = (
    Effect("kinematic_error", "physics", (Form("lagrange", _make_kinematic),), lambda scene: (2e-5, 1e-3)),
    Effect(
        "joint_elasticity",
        "physics",
        (_make_elastic(0.0), _make_elastic(0.5)),
        lambda scene: (1.0 / (250.0**2 * scene.inertia), 1.0 / (60.0**2 * scene.inertia)),
    ),
    Effect(
        "backlash",
        "physics",
        (Form("dead zone", _make_backlash),),
        lambda scene: (2e-4, 8e-3 if scene.joint.family == "harmonic" else 2e-2),
        localised=True,
    ),
    Effect(
        "neighbour_coupling",
        "physics",
        (Form("two joints", _make_neighbour),),
        lambda scene: (0.01 * scene.inertia, 1.5 * scene.inertia),
        accepted=("external_disturbance", "unknown_physics"),
    ),
)
