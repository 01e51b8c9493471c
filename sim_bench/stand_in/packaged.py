"""The models that come with the package: the default joint and the paper's two-link arm."""

from __future__ import annotations

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
    "two_link_arm",
]

PACKAGED_MODELS = ("default_joint", "two_link_arm")

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
    sensor: SensorSettings | None = None,
    disturbances: Sequence[Disturbance] = ARM_DISTURBANCES,
    seed: int = 0,
) -> StandInSettings:
    """The arm of equation (1) of [luo2024pinn] in a vertical plane, hanging down at zero, -2.6 to 2.6 rad a joint.

    Args:
        laws: Friction of shoulder and elbow.
        sensor: Sensor chain of both; None for `sensors_for` each law.
        disturbances: External disturbance on shoulder and elbow; `NO_DISTURBANCE` for none.
        seed: Of the sensor noise.
    """
    servo = ServoSettings(torque_limit=12.0)
    joints = tuple(
        JointSettings(name, law, sensor or sensors_for(law), servo, disturbance=disturbance)
        for name, law, disturbance in zip(("shoulder", "elbow"), laws, disturbances, strict=True)
    )
    return StandInSettings(packaged_model("two_link_arm"), joints, seed=seed)
