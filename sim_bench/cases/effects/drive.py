"""Effects between the torque that the drive reports and the torque that reaches the joint."""

import numpy as np

from ..dynamics import SAMPLE_PERIOD
from ..effect import Change, Effect, Form, Scene, Truth


def _make_saturation(form: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        coefficient = amplitude / scene.load**2
        return Change(
            plant={"saturation": coefficient, "saturation_form": form},
            parameters={"coefficient": Truth(coefficient, "1/(N·m)²")},
        )

    return Form("root" if form else "cubic", build, shared=not form)


def _make_sag(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    coefficient = amplitude / (scene.load * scene.joint.speed)
    return Change(plant={"sag": coefficient}, parameters={"loss_by_power": Truth(coefficient, "1/W")})


def _lag(order: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        return Change(
            plant={"drive_lag": amplitude, "drive_order": order}, parameters={"time_constant": Truth(amplitude, "s")}
        )

    return Form(f"order {order:.0f}", build)


def _make_heating(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    time = rng.uniform(10.0, 25.0)
    gain = 40.0 / (time * (0.5 * scene.gravity**2 + scene.coulomb**2))  # about 40 K when the load is held
    return Change(
        plant={"winding_loss": amplitude, "winding_heating": gain, "winding_time": time},
        parameters={"sensitivity": Truth(amplitude, "1/K"), "time_constant": Truth(time, "s")},
    )


def _make_ripple(second: float) -> Form:
    """A torque constant that waves with the motor's angle, once or twice a turn of its magnets."""

    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        order, phase = scene.joint.gear_ratio * float(rng.choice([1, 2])), rng.uniform(0.0, 2.0 * np.pi)
        plant = {"torque_ripple": amplitude, "ripple_order": order, "ripple_phase": phase, "ripple_second": second}
        truth = {
            "sine": Truth(amplitude * np.sin(phase), "1"),
            "cosine": Truth(-amplitude * np.cos(phase), "1"),
            "order": Truth(order, "1/rad"),
        }
        return Change(plant=plant, parameters=truth)

    return Form("two waves" if second else "sine", build, shared=not second)


EFFECTS = (
    Effect("torque_saturation", "physics", (_make_saturation(0.0), _make_saturation(1.0)), lambda scene: (0.01, 0.35)),
    Effect("supply_sag", "physics", (Form("power", _make_sag),), lambda scene: (0.02, 0.5)),
    Effect(
        "drive_lag",
        "measurement",
        (_lag(1.0), _lag(2.0)),
        lambda scene: (1e-3, 1.2e-2),
        smallest=lambda scene: SAMPLE_PERIOD,  # less is where in its sample a torque belongs
    ),
    Effect("torque_ripple", "physics", (_make_ripple(0.0), _make_ripple(0.4)), lambda scene: (0.01, 0.3)),
    Effect("torque_constant_heating", "physics", (Form("copper", _make_heating),), lambda scene: (5e-4, 8e-3)),
)
