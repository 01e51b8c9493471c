"""From the drive's own unit of torque to newton metres: a known weight, hung on a lever, against what the drive reads.

The joint goes slowly to and fro, first without the weight and then with it. Friction turns its sign with the motion
and gravity does not, so that a fit of

    reading = a sin q + b cos q + c + d sign(dq)

takes friction off whatever it is, also where it grows with the load. What the weight adds to (a, b) has the size
m g r / K, wherever the arm's own weight hangs, and K is what one unit of the reading is in newton metres.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from fricomp.control.loop.ending import stopping_on_error
from fricomp.errors import IdentificationError, ParameterError, SweepAborted
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .motion.context import SweepContext, loop_period
from .motion.log import CycleLog
from .motion.motion import MotionRunner
from .motion.push import await_rest, push_joint
from .planning.plan import Travel, move_speed, possible_speeds, top_speed
from .planning.profile import move_profile
from .sweep import Progress

__all__ = [
    "GRAVITY",
    "HungWeight",
    "PassPlan",
    "TorqueConstant",
    "identify_torque_constant",
    "plan_passes",
    "record_passes",
]

GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s²]; it differs by up to 0.3 % from place to place."""

# Part of the travel a second, as far as the drive can be told so, and of its highest speed.
PACE, TOP_SHARE = 0.1, 0.2
# Motion of another joint that tilts the lever by too much [rad] or [m].
LARGEST_YIELD = 0.005
# Part of a pass at each end in which the joint still gets up to speed [1].
EDGE = 0.1
# Standard errors that the weight's part must have for it to count.
VISIBLE = 10.0
FEWEST_PASSES = 2


@dataclass(frozen=True)
class HungWeight:
    """A known weight on a lever.

    Attributes:
        mass: [kg].
        lever: From the axis to where it hangs [m].

    Raises:
        ParameterError: One is not positive.
    """

    mass: float
    lever: float

    def __post_init__(self) -> None:
        if not (0.0 < self.mass < np.inf and 0.0 < self.lever < np.inf):
            raise ParameterError(
                f"a hung weight needs finite mass and lever above 0, got {self.mass!r} kg on {self.lever!r} m: "
                "give --weight and --lever"
            )

    @property
    def moment(self) -> float:
        """Largest torque about a horizontal axis [N·m]."""
        return self.mass * GRAVITY * self.lever


@dataclass(frozen=True)
class TorqueConstant:
    """What a hung weight has told.

    Attributes:
        value: Torque on the joint for one unit of the reading [N·m per unit].
        deviation: Standard error of it, from the scatter among the passes.
        unit: Of the reading.
        bare: Largest reading of gravity without the weight, in this unit.
        added: What the weight adds to it at most, in this unit.
        gear_ratio: Drive turns for one joint turn, through which the reading was taken [1].
    """

    value: float
    deviation: float
    unit: str
    bare: float
    added: float
    gear_ratio: float = 1.0

    @property
    def at_drive(self) -> float:
        """Torque on the drive's own side of the gear for one unit of the reading [N·m per unit].

        A reading in the drive's own unit, such as amperes, is not scaled by the gear; one in newton metres is.
        """
        return self.value / self.gear_ratio


@dataclass(frozen=True)
class PassPlan:
    """How the joint will move without the weight, and the same with it.

    Attributes:
        travel: From end to end of which it goes.
        speed: Of the passes [rad/s] or [m/s].
        fastest: Of the way to the first pass and back after the last [rad/s] or [m/s].
        n_passes: To and fro.
        duration: Of all of them, with the ways [s].
    """

    travel: Travel
    speed: float
    fastest: float
    n_passes: int
    duration: float


def plan_passes(context: SweepContext, n_passes: int, at: float = 0.0) -> PassPlan:
    """The plan of `record_passes`, of a joint that turns freely about the position `at` [rad] or [m]."""
    travel, settings = context.travel(at), context.settings
    slow = min(PACE * travel.length, TOP_SHARE * top_speed(travel, settings))
    speed, fastest = float(possible_speeds([slow], travel, settings)[0]), move_speed(travel)
    one = move_profile(travel.length, speed, settings.ramp).duration
    way = move_profile(0.5 * travel.length, fastest, settings.ramp).duration
    return PassPlan(travel, speed, fastest, n_passes, 2.0 * n_passes * one + 2.0 * way)


def record_passes(
    context: SweepContext, n_passes: int, report: Progress = lambda text, done: None
) -> tuple[Recording, ...]:
    """Move the joint slowly over its travel, to and fro; each pass is a recording, up and down in turn.

    Where the loop is closed here, over commanded torque, a push of low torque has told before that signs and scales are
    right. The joint ends where it began, at rest and not energised; what goes wrong stops it before it is told.

    Raises:
        SweepAborted: A sign or scale is wrong, the joint does not move, the safety gate has tripped, or another joint
            gave way, which tilts the lever.
        ParameterError: A loop on the host lacks an inertia.
        AdapterError: The drive does not do as it is told.
    """
    with stopping_on_error(context.adapter):
        return _record_passes(context, n_passes, report)


def _record_passes(context: SweepContext, n_passes: int, report: Progress) -> tuple[Recording, ...]:
    adapter, settings = context.adapter, context.settings
    mode = context.choose_mode()
    runner = MotionRunner(adapter, context.joint, loop_period(adapter, settings, mode))
    adapter.configure(mode, runner.period)
    runner.await_feedback()
    if mode == "torque":
        context.make_loop(mode, runner.period, runner.feedback.position)  # refused before anything moves
        await_rest(runner, context.travel(runner.position), context.metadata().joint)
    plan = plan_passes(context, n_passes, runner.position)
    travel, rest = plan.travel, runner.position
    if mode == "torque":
        report("checking signs at low torque", 0.0)
        push_joint(runner, context, travel).judge(context.metadata())
    runner.start(context.make_loop(mode, runner.period, runner.feedback.position))
    runner.meanwhile(lambda: report("going to the start", 0.0))
    runner.move_to(travel.low, plan.fastest, settings.ramp)
    found = []
    for number in range(2 * n_passes):
        runner.meanwhile(partial(report, "moving to and fro", number / (2 * n_passes)))
        found.append(_pass(runner, context, travel, plan.speed))
    runner.move_to(rest, plan.fastest, settings.ramp)
    runner.stop()
    return tuple(found)


def _pass(runner: MotionRunner, context: SweepContext, travel: Travel, speed: float) -> Recording:
    """One way over the travel, from the end the joint is at."""
    goal = travel.high if runner.position < travel.middle else travel.low
    profile = move_profile(goal - runner.position, speed, context.settings.ramp)
    start_ns = runner.now_ns
    log = runner.follow(lambda time: profile.velocity_at(time) if time < profile.duration else None)
    return runner.meanwhile(lambda: _to_recording(log, context, start_ns))


def _to_recording(log: CycleLog, context: SweepContext, start_ns: int) -> Recording:
    others = np.delete(log.configuration(), context.joint, axis=1)
    gave_way = float(np.max(np.ptp(others, axis=0))) if others.size else 0.0
    if gave_way > LARGEST_YIELD:
        raise SweepAborted(
            f"another joint gave way by {gave_way:.2g} while joint {context.metadata().joint!r} moved, which tilts the "
            "lever: lock it, or make its loop stiffer"
        )
    return log.to_recording(start_ns, context.metadata(), None)


def identify_torque_constant(
    bare: Sequence[Recording], loaded: Sequence[Recording], weight: HungWeight, gear_ratio: float = 1.0
) -> TorqueConstant:
    """The torque constant from passes without and with the weight, two by two in both directions.

    Args:
        bare: Without the weight.
        loaded: With it.
        weight: What was hung.
        gear_ratio: Drive turns for one joint turn.

    Raises:
        IdentificationError: The weight does not show, or there are too few passes.
    """
    pairs = min(len(bare), len(loaded)) // 2
    if pairs < FEWEST_PASSES:
        raise IdentificationError(f"{pairs} passes in both directions are too few, {FEWEST_PASSES} are needed")
    unit = bare[0].metadata.torque_unit
    empty = np.array([_fit_gravity(bare[2 * k : 2 * k + 2]) for k in range(pairs)])
    full = np.array([_fit_gravity(loaded[2 * k : 2 * k + 2]) for k in range(pairs)])
    added = full - empty
    size = float(np.hypot(*added.mean(axis=0)))
    error = float(np.sqrt(np.sum(np.var(added, axis=0, ddof=1)) / pairs))  # of both parts: rather too much
    if size <= VISIBLE * error:
        raise IdentificationError(
            f"the weight of {weight.moment:.3g} N·m changes the reading by {size:.3g} ± {2.0 * error:.1g} {unit} only: "
            "hang it on an axis that is horizontal, farther out or heavier, and take it off for the first passes"
        )
    own = float(np.hypot(*empty.mean(axis=0)))
    value = weight.moment / size
    return TorqueConstant(value, value * error / size, unit, own, size, gear_ratio)


def _fit_gravity(passes: Sequence[Recording]) -> FloatArray:
    """The part a sin q + b cos q of what one pass up and one down have read. Shape (2,)."""
    rows, readings = [], []
    for samples in passes:
        low, high = float(samples.position.min()), float(samples.position.max())
        inside = (samples.position > low + EDGE * (high - low)) & (samples.position < high - EDGE * (high - low))
        q = samples.position[inside]
        direction = np.full(len(q), np.sign(samples.position[-1] - samples.position[0]))
        rows.append(np.column_stack([np.sin(q), np.cos(q), np.ones_like(q), direction]))
        readings.append(samples.torque[inside])
    solution, *_ = np.linalg.lstsq(np.vstack(rows), np.concatenate(readings), rcond=None)
    return np.asarray(solution[:2])
