"""Friction of healthy joints, and what each effect does to one of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .friction import FIELDS, PLACE
from .plant import Gap

_COULOMB = np.array([9.0, 10.0, 6.0, 2.2, 2.0, 1.6])  # [N·m]
_VISCOUS = np.array([9.0, 9.0, 6.0, 1.8, 1.6, 1.3])  # [N·m·s/rad]


@dataclass(frozen=True)
class JointScene:
    """What an effect is measured by.

    Attributes:
        number: Of the joint.
        fields: Its healthy friction.
        load: Root mean square of the torque that it transmits [N·m].
        speed: Its top speed [rad/s].
        middle: Mean position [rad].
        warming: How much warmer it gets [K].
    """

    number: int
    fields: Mapping[str, float]
    load: float
    speed: float
    middle: float
    warming: float

    @property
    def coulomb(self) -> float:
        """Mean Coulomb torque [N·m]."""
        return 0.5 * (self.fields["coulomb_forward"] + self.fields["coulomb_reverse"])


@dataclass(frozen=True)
class ArmChange:
    """What an effect sets in one joint.

    Attributes:
        fields: Of its friction.
        gap: Of its gear.
        gain: Factor on its recorded torque.
        delay: By which its torque is later than that of the others [s].
        truth: Parameters by the catalogue's names, in SI.
    """

    fields: Mapping[str, float] = field(default_factory=dict)
    gap: Gap | None = None
    gain: float = 1.0
    delay: float = 0.0
    truth: Mapping[str, float] = field(default_factory=dict)


def draw_friction(rng: np.random.Generator) -> NDArray[np.float64]:
    """Bidirectional Stribeck curves of six healthy joints, both ways the same to 3 %. Shape (6, n_fields)."""
    table = np.zeros((6, len(FIELDS)))
    for j in range(6):
        level = _COULOMB[j] * np.exp(0.25 * rng.standard_normal())
        uneven = 1.0 + 0.03 * rng.standard_normal()
        values = {
            "coulomb_forward": level * uneven,
            "coulomb_reverse": level / uneven,
            "excess": level * rng.uniform(0.0, 0.4),
            "stribeck_velocity": np.exp(rng.uniform(np.log(0.03), np.log(0.3))),
            "viscous": _VISCOUS[j] * np.exp(0.25 * rng.standard_normal()),
        }
        for name, value in values.items():
            table[j, PLACE[name]] = value
    return table


def change_joint(effect: str, scene: JointScene, rng: np.random.Generator) -> ArmChange:
    """The change that an effect makes in a joint, as large as it is on real arms."""
    return _MAKERS[effect](scene, rng)


def _spread(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _load_coulomb(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    c = _spread(rng, 0.04, 0.29)
    return ArmChange({"load_coulomb": c}, truth={"coefficient": c})


def _load_quadratic(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    c = _spread(rng, 0.06, 0.3) / scene.load
    return ArmChange({"load_quadratic": c}, truth={"coefficient": c})


def _position(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    size, angle = scene.coulomb * _spread(rng, 0.06, 0.25), rng.uniform(0.0, 2.0 * np.pi)
    order = float(rng.choice([1.0, 2.0]))
    cosine, sine = size * np.cos(angle), size * np.sin(angle)
    fields = {"position_cosine": cosine, "position_sine": sine, "position_order": order}
    return ArmChange(fields, truth={"cosine": cosine, "sine": sine} if order == 1.0 else {})


def _presliding(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    return ArmChange({"breakaway": (d := _spread(rng, 1e-3, 1e-2))}, truth={"breakaway_distance": d})


def _drag(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    c = _spread(rng, 0.15, 0.8) * scene.fields["viscous"] / scene.speed
    return ArmChange({"drag": c}, truth={"coefficient": c})


def _power(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    n, viscous = rng.uniform(0.5, 0.8), scene.fields["viscous"]
    size = _spread(rng, 0.6, 1.5) * viscous * scene.speed ** (1.0 - n)
    return ArmChange({"power": size, "exponent": n, "viscous": 0.2 * viscous})


def _spring(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    k = scene.coulomb * _spread(rng, 0.08, 0.6)
    return ArmChange({"stiffness": k, "middle": scene.middle}, truth={"stiffness": k})


def _cogging(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    size, order = scene.coulomb * _spread(rng, 0.03, 0.2), float(round(_spread(rng, 6.0, 60.0)))
    return ArmChange({"ripple": size, "ripple_order": order, "ripple_phase": rng.uniform(0.0, 2.0 * np.pi)})


def _thermal(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    return ArmChange({"warming": -_spread(rng, 0.15, 0.5) / scene.warming})


def _gain(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    error = _sign(rng) * _spread(rng, 0.03, 0.12)
    return ArmChange(gain=1.0 + error, truth={"gain_error": error})


def _delay(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    late = _spread(rng, 3e-3, 1e-2)
    return ArmChange(delay=late, truth={"delay": late})


def _backlash(scene: JointScene, rng: np.random.Generator) -> ArmChange:
    width = _spread(rng, 1e-3, 8e-3)
    return ArmChange(gap=Gap(scene.number, width, 2e4 if scene.number < 3 else 8e3), truth={"gap": width})


_MAKERS: dict[str, Callable[[JointScene, np.random.Generator], ArmChange]] = {
    "load_coulomb": _load_coulomb,
    "load_quadratic": _load_quadratic,
    "position_coulomb": _position,
    "presliding_hysteresis": _presliding,
    "quadratic_drag": _drag,
    "power_law_viscous": _power,
    "spring_torque": _spring,
    "cogging": _cogging,
    "thermal_friction": _thermal,
    "torque_gain_error": _gain,
    "torque_delay": _delay,
    "backlash": _backlash,
}
