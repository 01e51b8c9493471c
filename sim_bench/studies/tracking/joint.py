"""The joints that are tracked, what is known of them, and the loop around them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fricomp.control import LoopDynamics, PositionController
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, Validity

from ...stand_in import DEFAULT_LAW, SensorSettings

INERTIA = 0.1
"""Of the stand-in's default joint [kg·m²]."""

PERIOD = 1e-3
"""Of every loop [s]."""

_RANGE = (-1.0, 1.0)  # the velocities of the paper's data [rad/s]


@dataclass(frozen=True)
class TrackedJoint:
    """A joint whose friction is known exactly, so that only the compensation is compared.

    Attributes:
        name: Short.
        title: What it is.
        law: Its friction.
    """

    name: str
    title: str
    law: FrictionLaw

    @property
    def model(self) -> FrictionModel:
        """The friction as a model."""
        return FrictionModel(self.law, joint=self.name, validity=Validity(velocity=_RANGE))

    @property
    def coulomb_viscous_model(self) -> FrictionModel:
        """The rival: Coulomb and viscous friction of each direction, fitted to the curve by least squares."""
        curves = []
        for sign in (1.0, -1.0):
            speed = np.linspace(0.01, _RANGE[1], 100)
            level = np.abs(np.asarray(self.law.torque(sign * speed)))
            basis = np.column_stack([np.ones_like(speed), speed])
            coulomb, viscous = np.maximum(np.linalg.lstsq(basis, level, rcond=None)[0], 0.0).tolist()
            if viscous == 0.0:
                coulomb = float(np.mean(level))
            curves.append(StribeckCurve(coulomb, coulomb, 1.0, viscous))
        law = FrictionLaw((BidirectionalStribeck(curves[0], curves[1]),))
        return FrictionModel(law, joint=self.name, validity=Validity(velocity=_RANGE))


JOINTS: Mapping[str, TrackedJoint] = {
    "moderate": TrackedJoint(
        "moderate",
        "F_s/F_c = 1.5",
        FrictionLaw(
            (BidirectionalStribeck(StribeckCurve(0.40, 0.60, 0.05, 0.10), StribeckCurve(0.44, 0.66, 0.05, 0.12)),)
        ),
    ),
    "table_i": TrackedJoint("table_i", "F_s/F_c = 4, table I of the paper", DEFAULT_LAW),
}
"""By name."""


def scaled_law(law: FrictionLaw, scale: float) -> FrictionLaw:
    """`law` with all torques multiplied by `scale` [1]."""
    torques = ("coulomb_torque", "static_torque", "viscous_coefficient")
    return law.replace({n: v * scale for n, v in law.parameters().items() if n.rsplit(".", 1)[-1] in torques})


def loop_of(bandwidth: float, sensor: SensorSettings) -> tuple[PositionController, LoopDynamics]:
    """The PD controller of `bandwidth` [Hz], and the loop it makes; half a period each goes to difference and hold."""
    controller = PositionController.from_bandwidth([INERTIA], bandwidth)
    gains = controller.stiffness[0], controller.damping[0]
    return controller, LoopDynamics(INERTIA, *gains, sensor.delay + PERIOD, sensor.velocity_filter)
