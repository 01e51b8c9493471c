"""Other forms of effects than those that the catalogue of the diagnosis has, and drives that it does not have."""

from functools import partial

import numpy as np

from . import other_law
from .effect import Effect, built_of, written
from .hidden import Hidden
from .joint import JointParts
from .motion import Motion
from .physics import hang_behind


def _stop_both_ends(motion: Motion) -> Hidden:
    """The reference goes 0.1 rad beyond either end of the range."""
    low, high = float(np.min(motion.position)) + 0.1, float(np.max(motion.position)) - 0.1
    return Hidden(
        parts=JointParts(attributes=f'range="{low:.6f} {high:.6f}" limited="true" solreflimit="-300 -5"'),
    )


def _stop(motion: Motion, contact: str) -> Hidden:
    """The reference goes 0.1 rad beyond the upper end of the range; the lower one is out of reach."""
    edge = float(np.max(motion.position)) - 0.1
    return Hidden(parts=JointParts(attributes=f'range="-10 {edge:.6f}" limited="true" {contact}'))


_physics = partial(Effect, "physics")
_outside = partial(Effect, "outside")

FORMS = (
    _physics(
        "dwell_logarithmic",
        "`dof_frictionloss` grows at rest by 0.25 ln(1 + t / 0.05 s) N·m, and loses it over 5 mrad",
        written(lambda: other_law.LogarithmicDwell(0.25, 0.05, 5e-3)),
        form_of="dwell_stiction",
    ),
    _physics(
        "dwell_power",
        "`dof_frictionloss` grows at rest by 0.8 (t / 1 s)^0.4 N·m, and loses it within 0.1 s of sliding",
        written(lambda: other_law.PowerDwell(0.8, 0.4, 0.1)),
        form_of="dwell_stiction",
    ),
    _physics(
        "lag_second_order",
        "`dof_frictionloss` follows the velocity through two low passes of 5 ms",
        written(lambda: other_law.TwiceLateFriction(5e-3)),
        form_of="frictional_lag",
    ),
    _physics(
        "lag_pure_delay",
        "`dof_frictionloss` is that of the velocity 10 ms ago",
        written(lambda: other_law.DelayedFriction(40)),
        form_of="frictional_lag",
    ),
    _physics(
        "load_driving",
        "`dof_frictionloss` grows by 0.12 of the size of `qfrc_bias` where the motor lifts",
        written(lambda: other_law.driving_alone(0.12)),
        form_of="load_quadratic",
    ),
    _physics(
        "heating_twice",
        "`actuator_gainprm` falls by 0.2 % for each (N·m)² of the mean square torque over 4 s, and as much over 40 s",
        written(lambda: other_law.TwiceHeatedMotor((2e-3, 2e-3), (4.0, 40.0))),
        form_of="torque_constant_heating",
    ),
    _physics(
        "stop_both_ends",
        'both ends of the `range` 0.1 rad within what the reference asks for, `solreflimit="-300 -5"`',
        _stop_both_ends,
        form_of="end_stop",
    ),
    _physics(
        "stop_damped",
        'upper end of the `range` 0.1 rad below what the reference asks for, `solreflimit="-300 -40"`',
        lambda motion: _stop(motion, 'solreflimit="-300 -40"'),
        form_of="end_stop",
    ),
    _physics(
        "stop_stiffening",
        "the same, whose `solimplimit` rises from 0.1 to 0.9 within 80 mrad",
        lambda motion: _stop(motion, 'solreflimit="-100 -5" solimplimit="0.1 0.9 0.08"'),
        form_of="end_stop",
    ),
    _physics(
        "backlash_small",
        "the link hangs on a second hinge that is free within a `range` of 1.5 mrad",
        built_of(
            hang_behind('range="-0.00075 0.00075" limited="true" damping="0.1" solreflimit="-20000 -100"'),
            {"gap": 1.5e-3},
        ),
        form_of="backlash",
    ),
    _physics(
        "backlash_soft",
        "the same within 4 mrad, of a fifth of the stiffness",
        built_of(
            hang_behind('range="-0.002 0.002" limited="true" damping="0.1" solreflimit="-4000 -20"'), {"gap": 4e-3}
        ),
        form_of="backlash",
    ),
    _outside(
        "drive_dead_band",
        "`qfrc_applied` takes the innermost 0.4 N·m off the torque, to either side",
        written(lambda: other_law.dead_band(0.4)),
    ),
    _outside(
        "drive_rate_limit",
        "`qfrc_applied` holds the torque back to 60 N·m/s",
        written(lambda: other_law.LimitedRate(60.0)),
    ),
)
