"""What makes one concealed arm."""

from dataclasses import dataclass

import numpy as np

from fricomp.errors import DiagnosisError

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
"""Of the packaged arm, from its foot to its flange."""

ARM_EFFECTS = (
    "load_coulomb",
    "load_quadratic",
    "position_coulomb",
    "presliding_hysteresis",
    "quadratic_drag",
    "power_law_viscous",
    "spring_torque",
    "cogging",
    "thermal_friction",
    "torque_gain_error",
    "torque_delay",
    "backlash",
)
"""What can be concealed in a joint, by the catalogue's names."""

_LOADED = ("load_coulomb", "load_quadratic", "torque_gain_error", "backlash")
"""Effects that show only in joints that bear a load: none of the base, whose axis is vertical, nor of the last."""

_TWO_MASSES = "backlash"
"""An arm has one joint whose motor moves on its own at most."""

_SHARES = {"null": 0.2, "single": 0.5, "pair": 0.3}
"""How many arms have no effect, one and two."""


@dataclass(frozen=True)
class ArmSpec:
    """One concealed arm.

    Attributes:
        seed: Draws links, friction, motion, sensors and the sizes of effects.
        effects: Pairs of a joint's name and an effect's.
        wrong_links: How many links are far off the simulation.
        duration: Of the recording [s].
    """

    seed: int
    effects: tuple[tuple[str, str], ...] = ()
    wrong_links: int = 2
    duration: float = 60.0


def draw_spec(seed: int, duration: float = 60.0) -> ArmSpec:
    """A spec with effects and wrong links as they come: a fifth of the arms have no effect, a third has two."""
    rng = np.random.default_rng([seed, 1])
    count = int(rng.choice(3, p=list(_SHARES.values())))
    effects: list[tuple[str, str]] = []
    while len(effects) < count:
        effect = str(rng.choice(ARM_EFFECTS))
        joint = str(rng.choice(JOINTS[1:5] if effect in _LOADED else JOINTS))
        taken = {name for _, name in effects}
        if (joint, effect) not in effects and not (effect == _TWO_MASSES and effect in taken):
            effects.append((joint, effect))
    return ArmSpec(seed, tuple(effects), int(rng.integers(0, 4)), duration)


def parse_effect(text: str) -> tuple[str, str]:
    """Joint and effect from JOINT:NAME.

    Raises:
        DiagnosisError: There is no such joint or effect.
    """
    joint, _, effect = text.partition(":")
    if joint not in JOINTS or effect not in ARM_EFFECTS:
        raise DiagnosisError(
            f"--effect {text!r} is not JOINT:NAME; joints are {', '.join(JOINTS)}; effects {', '.join(ARM_EFFECTS)}"
        )
    return joint, effect
