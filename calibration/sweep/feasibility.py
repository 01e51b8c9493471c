"""What can be told of a calibration before anything moves: whether it can come to its end at all."""

from fricomp.errors import ParameterError

from .estimate import FEWEST_POINTS
from .motion.context import SweepContext, loop_period
from .planning.plan import SweepPlan, default_speeds, plan_plateaus
from .request import CalibrationOptions

__all__ = ["check_feasible"]

# Plateaus at the first speed once more, at the end.
AGAIN = 2


def check_feasible(context: SweepContext, options: CalibrationOptions) -> SweepPlan:
    """Refuse what would fail only after minutes of sweeping; nothing is energised.

    Returns:
        The plan of the first pass, of a joint that turns freely about 0.

    Raises:
        ParameterError: A speed does not fit, there are too few plateaus, the normal load is not to be had, or a loop on
            the host lacks an inertia.
        AdapterConfigurationError: The drive cannot close the loop as asked for.
    """
    mode, travel, settings = context.choose_mode(), context.travel(), context.settings
    plan = plan_plateaus(default_speeds(travel, settings), travel, settings)
    _check_count(len(plan.plateaus) + (0 if options.adaptive else AGAIN))
    _check_load(context, options)
    places = [0.0] * len(context.adapter.capabilities.joints)
    period = loop_period(context.adapter, settings, mode)
    context.make_loop(mode, period, places)
    if "torque" in context.adapter.capabilities.modes:
        context.make_check_loop(period, places)
    return plan


def _check_count(planned: int) -> None:
    """An adaptive sweep identifies from the first pass alone, any other at its end."""
    if planned < FEWEST_POINTS:
        raise ParameterError(
            f"the sweep would have {planned} plateaus, at least {FEWEST_POINTS} are needed: give more --speeds or "
            "--repeats"
        )


def _check_load(context: SweepContext, options: CalibrationOptions) -> None:
    if options.normal_load == "transmitted" and (
        context.body is None or not context.body.has_gravity_on(context.joint)
    ):
        raise ParameterError(
            "no model says that a load acts on this joint, so none is transmitted: give the mechanism with --model, or "
            "use none or a number as the normal load"
        )
