"""Parameters and signals that are wrong."""

from collections.abc import Callable
from functools import partial
from math import cos, sin

from . import law
from .effect import Effect, always, built_of, motor, written
from .hidden import Hidden
from .joint import ARMATURE, LINK, JointParts
from .motion import Motion

_GRAVITY = 9.81  # [m/s²]
_UNROUND = (4e-3, 0.5)  # [rad], phase


def _payload() -> Callable[[Motion], Hidden]:
    mass, arm, own = 0.4, 0.4, 1e-3
    body = (
        f'<body name="payload" pos="0 0 -{arm}"><inertial pos="0 0 0" mass="{mass}" diaginertia="{own} {own} {own}"/>'
    )
    truth = {
        "gravity_cos_change": 0.0,
        "gravity_sin_change": mass * _GRAVITY * arm,
        "inertia_change": mass * arm**2 + own,
    }
    return built_of(JointParts(link=f"{LINK}{body}</body>"), truth)


_parameter = partial(Effect, "parameter")
_measurement = partial(Effect, "measurement")

FLAWS = (
    _parameter(
        "inertia_error",
        "`armature` is 0.25 kg·m², in the simulation 0.15",
        built_of(JointParts(armature=ARMATURE + 0.1), {"inertia_change": 0.1}),
    ),
    _parameter("payload_error", "a child body of 0.4 kg, 0.4 m from the axis", _payload()),
    _measurement(
        "torque_gain_error",
        "`gear` of the motor is 0.94, so that the recorded torque is too large",
        built_of(motor('gear="0.94"'), {"gain_error": 1.0 / 0.94 - 1.0}),
    ),
    _measurement(
        "drive_lag",
        "the motor has an activation: `filterexact` of 4 ms",
        built_of(motor('dyntype="filterexact" dynprm="0.004" gainprm="1"', "general"), {"time_constant": 4e-3}),
    ),
    _measurement(
        "torque_delay",
        "the torque is recorded four samples late",
        always(Hidden(torque_delay=4, truth={"delay": 4e-3})),
    ),
    _measurement(
        "encoder_eccentricity",
        "the encoder reads 4 mrad · sin(q + 0.5) too much, also for the loop",
        always(
            Hidden(
                eccentricity=_UNROUND,
                truth={"sine": _UNROUND[0] * cos(_UNROUND[1]), "cosine": _UNROUND[0] * sin(_UNROUND[1])},
            )
        ),
    ),
    _parameter(
        "torque_offset", "`qfrc_applied` of 0.5 N·m throughout", written(lambda: law.constant(0.5), {"offset": -0.5})
    ),
    _parameter(
        "direction_asymmetry",
        "`dof_frictionloss` is 10 % larger forwards and 10 % smaller backwards",
        written(lambda: law.uneven(0.1), {"asymmetry": 0.1}),
    ),
)
