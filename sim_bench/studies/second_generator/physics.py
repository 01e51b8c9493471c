"""Physics of the catalogue that MuJoCo can have, with true parameters."""

from functools import partial
from math import cos, sin, sqrt

import numpy as np

from . import law
from .effect import Effect, always, built_of, motor, written
from .hidden import Hidden
from .joint import ARMATURE, COULOMB, INERTIA, JOINT, LENGTH, LINK, MASS, STICKING, TURNING, VISCOUS, JointParts
from .motion import PERIOD, Motion

_GRAVITY = 9.81  # [m/s²]
_LOAD = MASS * LENGTH**2 + TURNING  # [kg·m²] of the link about its axis
_MOTOR_SIDE = '<inertial pos="0 0 0" mass="0.01" diaginertia="1e-5 1e-5 1e-5"/>'  # a motor's side without a link
_STIFFNESS, _DAMPING, _GAP = 400.0, 1.5, 8e-3  # [N·m/rad], [N·m·s/rad], [rad] from side to side
_ELASTIC = {
    "stiffness": _STIFFNESS,
    "load_share": _LOAD / (_LOAD + ARMATURE + 1e-5),
    "damping_ratio": _DAMPING / (2.0 * sqrt(_STIFFNESS * _LOAD)),
}
_WAVE, _COG = (0.24, 6.0, 0.4), (0.25, 18.0, 1.0)  # [N·m], waves a turn, phase
_RIPPLE = (0.06, 17.0, 0.7)  # [1], waves a turn, phase


def hang_behind(joint: str) -> JointParts:
    """The link behind a second hinge, which turns against the first."""
    body = f'<body name="link"><joint name="gear" type="hinge" axis="0 1 0" {joint}/>{LINK}</body>'
    return JointParts(link=_MOTOR_SIDE + body)


def _slider() -> JointParts:
    """Dry friction acts on a small inertia of its own, which a spring ties to the joint."""
    body = (
        f'<body name="slider"><joint name="slider" type="hinge" axis="0 1 0" armature="2e-4" frictionloss="{COULOMB}" '
        f"{STICKING}/>{_MOTOR_SIDE}</body>"
    )
    spring = (
        f'<tendon><fixed stiffness="{COULOMB / 3e-3}" damping="0.3" springlength="0">'
        f'<joint joint="{JOINT}" coef="1"/><joint joint="slider" coef="-1"/></fixed></tendon>'
    )
    return JointParts(beside=body, connection=spring, bearer="slider")


def _end_stop(motion: Motion) -> Hidden:
    """The reference goes 0.1 rad beyond the upper end of the range; the lower one is out of reach."""
    edge = float(np.max(motion.position)) - 0.1
    return Hidden(
        parts=JointParts(attributes=f'range="-10 {edge:.6f}" limited="true" solreflimit="-300 -5"'),
        truth={"edge": edge},
    )


def _saturation(motion: Motion) -> Hidden:
    """Force range at 0.95 of the largest torque that the reference asks for."""
    acceleration = np.gradient(motion.velocity, PERIOD)
    friction = COULOMB * np.sign(motion.velocity) + VISCOUS * motion.velocity
    gravity = MASS * _GRAVITY * LENGTH * np.sin(motion.position)
    limit = 0.95 * float(np.max(np.abs(INERTIA * acceleration + gravity + friction)))
    return Hidden(parts=motor(f'forcelimited="true" forcerange="-{limit:.6f} {limit:.6f}"'))


def _pushes(motion: Motion) -> Hidden:
    """Two pushes, each 1.5 N·m for a thirtieth and a fortieth of the time."""
    windows = [(motion.duration * a, motion.duration * b, t) for a, b, t in ((0.34, 0.374, 1.5), (0.735, 0.76, -1.5))]
    truth: dict[str, float] = {}
    for number, (start, end, torque) in enumerate(windows, start=1):
        truth |= {f"start_{number}": start, f"end_{number}": end, f"torque_{number}": -torque}
    return Hidden(law=lambda: law.pushes(windows), truth=truth)


_physics = partial(Effect, "physics")

PHYSICS = (
    _physics(
        "load_coulomb",
        "`dof_frictionloss` grows by 0.1 of the size of `qfrc_bias`",
        written(lambda: law.by_load(coulomb=0.1), {"coefficient": 0.1, "inertia_share": 0.0}),
    ),
    _physics(
        "load_stribeck",
        "the static part of `dof_frictionloss` grows by 0.15 of the size of `qfrc_bias`",
        written(lambda: law.by_load(stribeck=0.15), {"coefficient": 0.15, "inertia_share": 0.0}),
    ),
    _physics(
        "load_quadratic",
        "`dof_frictionloss` grows by 0.01 /(N·m) of the square of `qfrc_bias`",
        written(lambda: law.by_load(quadratic=0.01), {"coefficient": 0.01, "inertia_share": 0.0}),
    ),
    _physics(
        "position_coulomb",
        "`dof_frictionloss` waves with the angle: 0.24 N·m, six waves a turn",
        written(
            lambda: law.waving_level(*_WAVE),
            {"cosine": _WAVE[0] * cos(_WAVE[2]), "sine": -_WAVE[0] * sin(_WAVE[2]), "order": _WAVE[1]},
        ),
    ),
    _physics(
        "cogging",
        "`qfrc_applied` ripples with the angle: 0.25 N·m, 18 waves a turn",
        written(
            lambda: law.ripple(*_COG),
            {"sine": _COG[0] * cos(_COG[2]), "cosine": _COG[0] * sin(_COG[2]), "order": _COG[1]},
        ),
    ),
    _physics(
        "presliding_hysteresis",
        "`frictionloss`, of one level, acts on a second body of 0.0002 kg·m²; a tendon ties it to the joint and gives "
        "3 mrad at that level",
        always(Hidden(parts=_slider(), law=lambda: law.level)),
    ),
    _physics(
        "frictional_lag",
        "`dof_frictionloss` follows the velocity through a low pass of 8 ms",
        written(lambda: law.LateFriction(8e-3)),
    ),
    _physics(
        "dwell_stiction",
        "`dof_frictionloss` grows at rest by up to 1 N·m within 0.5 s, and loses it over 2 mrad",
        written(lambda: law.Dwell(1.0, 0.5, 2e-3), {"rise": 1.0, "time_constant": 0.5, "travel": 2e-3}),
    ),
    _physics(
        "thermal_friction",
        "`dof_damping` falls by 1.5 % a kelvin of the recorded temperature, which the motor's power raises",
        written(lambda: law.thinning(0.015), {"coulomb_slope": 0.0}),
    ),
    _physics(
        "stribeck_shape",
        "`dof_frictionloss` falls with the exponent 0.6",
        written(lambda: law.other_shape(0.6), {"stribeck_exponent": 0.6}),
    ),
    _physics(
        "power_law_viscous",
        "`dof_damping` times velocity is 1.2 |v|^0.6",
        written(lambda: law.power_law(1.2, 0.6), {"coefficient": 1.2, "exponent": 0.6}),
    ),
    _physics(
        "quadratic_drag",
        '`damping="1.2 0.8"`: MuJoCo\'s polynomial, whose second part is 0.8 v |v|',
        built_of(JointParts(damping=f"{VISCOUS} 0.8"), {"coefficient": 0.8}),
    ),
    _physics(
        "joint_elasticity",
        "the link hangs on a second hinge with `stiffness` 400 and `damping` 1.5",
        built_of(hang_behind(f'stiffness="{_STIFFNESS}" damping="{_DAMPING}"'), _ELASTIC),
    ),
    _physics(
        "backlash",
        "the link hangs on a second hinge that is free within a `range` of 8 mrad",
        built_of(
            hang_behind(f'range="-{_GAP / 2} {_GAP / 2}" limited="true" damping="0.1" solreflimit="-20000 -100"'),
            {"gap": _GAP, "load_share": _ELASTIC["load_share"]},
        ),
    ),
    _physics(
        "torque_saturation",
        "`forcerange` of the motor at 0.95 of the largest torque that the reference asks for",
        _saturation,
    ),
    _physics(
        "torque_ripple",
        "`actuator_gainprm` waves with the angle: by 6 % of itself, 17 waves a turn",
        written(
            lambda: law.rippling_motor(*_RIPPLE),
            {"sine": -_RIPPLE[0] * cos(_RIPPLE[2]), "cosine": -_RIPPLE[0] * sin(_RIPPLE[2]), "order": _RIPPLE[1]},
        ),
    ),
    _physics(
        "torque_constant_heating",
        "`actuator_gainprm` falls by 0.4 % for each (N·m)² of the mean square torque, over 15 s",
        written(lambda: law.HeatedMotor(4e-3, 15.0), {"time_constant": 15.0}),
    ),
    _physics(
        "supply_sag",
        "`actuator_gainprm` falls by 0.5 % for each watt of the motor's power",
        written(lambda: law.sagging(5e-3), {"coefficient": 0.0, "loss_by_power": 5e-3}),
    ),
    _physics(
        "spring_torque",
        '`stiffness="1" springref="0.17"` of the joint',
        built_of(JointParts(attributes='stiffness="1" springref="0.17"'), {"stiffness": 1.0}),
    ),
    _physics(
        "end_stop",
        'upper end of the `range` 0.1 rad below what the reference asks for, `solreflimit="-300 -5"`',
        _end_stop,
    ),
    _physics(
        "external_disturbance", "`qfrc_applied` of 1.5 N·m for 2 s and of -1.5 N·m for 1.5 s of a minute", _pushes
    ),
)
