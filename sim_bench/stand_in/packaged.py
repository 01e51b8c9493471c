"""The models that come with the package: the default joint, the paper's two-link arm, and an arm of six joints."""

from collections.abc import Sequence
from pathlib import Path

from fricomp.errors import ParameterError
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve

from .disturbance import Disturbance, Sinusoid
from .sensor import SensorSettings
from .servo import ServoSettings
from .stand_in import JointSettings, StandInSettings

__all__ = [
    "DEFAULT_LAW",
    "NO_DISTURBANCE",
    "PACKAGED_MODELS",
    "default_joint",
    "packaged_model",
    "sensors_for",
    "six_joint_arm",
    "two_link_arm",
]

PACKAGED_MODELS = ("default_joint", "two_link_arm", "six_joint_arm")

# Table I of [luo2024pinn].
DEFAULT_LAW = FrictionLaw(
    (
        BidirectionalStribeck(
            forward=StribeckCurve(0.15, 0.60, 0.05, 0.02),
            reverse=StribeckCurve(0.20, 0.70, 0.05, 0.03),
        ),
    )
)

NO_DISTURBANCE = (Disturbance(), Disturbance())

# The paper gives no numbers for tau_d: a tenth of the Coulomb torque, slow beside the servo.
ARM_DISTURBANCES = (
    Disturbance((Sinusoid(0.015, 0.7), Sinusoid(0.005, 3.1, 1.0))),
    Disturbance((Sinusoid(0.015, 1.1, 0.5), Sinusoid(0.005, 4.3, 2.0))),
)


def packaged_model(name: str) -> Path:
    """Path of a model file of the package.

    Raises:
        ParameterError: There is none of this name.
    """
    if name not in PACKAGED_MODELS:
        raise ParameterError(f"no packaged model {name!r}; there are {', '.join(PACKAGED_MODELS)}")
    return Path(__file__).parent / "mjcf" / f"{name}.xml"


def sensors_for(law: FrictionLaw) -> SensorSettings:
    """The default sensor chain: torque noise of 2 % and offset of 0.5 % of the law's mean Coulomb torque."""
    levels = [value for name, value in law.parameters().items() if name.endswith("coulomb_torque")]
    coulomb = sum(levels) / len(levels) if levels else 0.0
    return SensorSettings(torque_noise=0.02 * coulomb, torque_offset=0.005 * coulomb)


def default_joint(
    *, law: FrictionLaw = DEFAULT_LAW, sensor: SensorSettings | None = None, seed: int = 0
) -> StandInSettings:
    """One joint of 0.1 kg·m² in the horizontal plane, -3 to 3 rad, with the friction of the paper's table I.

    Args:
        law: Another friction.
        sensor: Another sensor chain; None for `sensors_for(law)`.
        seed: Of the sensor noise.
    """
    joint = JointSettings("joint", law, sensor or sensors_for(law))
    return StandInSettings(packaged_model("default_joint"), (joint,), seed=seed)


def two_link_arm(
    *,
    laws: Sequence[FrictionLaw] = (DEFAULT_LAW, DEFAULT_LAW),
    disturbances: Sequence[Disturbance] = ARM_DISTURBANCES,
    seed: int = 0,
) -> StandInSettings:
    """The arm of equation (1) of [luo2024pinn] in a vertical plane, hanging down at zero, -2.6 to 2.6 rad a joint.

    Args:
        laws: Friction of shoulder and elbow.
        disturbances: External disturbance on shoulder and elbow; `NO_DISTURBANCE` for none.
        seed: Of the sensor noise.
    """
    servo = ServoSettings(torque_limit=12.0)
    joints = tuple(
        JointSettings(name, law, sensors_for(law), servo, disturbance=disturbance)
        for name, law, disturbance in zip(("shoulder", "elbow"), laws, disturbances, strict=True)
    )
    return StandInSettings(packaged_model("two_link_arm"), joints, seed=seed)


# Levels [N·m], static over sliding, Stribeck velocities [rad/s] and viscous coefficients [N·m·s/rad] of an arm with
# gears of 100 in its first three joints and of 50 in its wrist; of the size that arms of this reach have.
_SIX_JOINTS = {
    "base": (9.0, 1.2, 0.08, 9.0),
    "shoulder": (10.0, 1.25, 0.08, 9.0),
    "elbow": (6.0, 1.2, 0.1, 6.0),
    "wrist_1": (2.2, 1.15, 0.15, 1.8),
    "wrist_2": (2.0, 1.15, 0.15, 1.6),
    "wrist_3": (1.6, 1.15, 0.15, 1.3),
}


def six_joint_arm() -> StandInSettings:
    """An arm of our own with 1 m of reach, standing straight up at zero; gravity acts on five of its six joints."""
    laws = [
        FrictionLaw((BidirectionalStribeck(*(StribeckCurve(level, level * rise, slow, viscous),) * 2),))
        for level, rise, slow, viscous in _SIX_JOINTS.values()
    ]
    servo = ServoSettings(torque_limit=200.0)
    joints = tuple(
        JointSettings(name, law, sensors_for(law), servo) for name, law in zip(_SIX_JOINTS, laws, strict=True)
    )
    return StandInSettings(packaged_model("six_joint_arm"), joints)
