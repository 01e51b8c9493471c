"""The first motion of all: a push that rises slowly, while nothing holds the joint but its friction."""

from math import inf
from typing import NamedTuple

import numpy as np

from fricomp.errors import SweepAborted
from fricomp.recording import RecordingMetadata

from ..planning.plan import Travel
from .context import SweepContext
from .log import CycleLog
from .motion import MotionRunner
from .sign_check import SignCheck, check_signs

__all__ = ["Push", "await_rest", "push_joint"]

# Distance that ends the push, as a fraction of the travel; time over which its torque rises [s].
ENOUGH = 0.01
RISE = 3.0
# A joint rests that moves by less than this fraction of its travel, or some encoder counts, over a while [s]; a
# pendulum on a geared joint has come to rest long before the patience ends [s].
STILL, COUNTS, WHILE, PATIENCE = 1e-4, 3, 0.3, 30.0
# A joint that was torn loose is looked at so often, and not longer, until its friction has brought it to rest [s].
GLIMPSE, LONGEST_COAST = 0.05, 2.0


class Push(NamedTuple):
    """What a push did.

    Attributes:
        log: Every cycle of it.
        limit: Torque that it would have come to [N·m], [N] or the actuator's own unit.
        has_moved: Whether the joint has moved before that.
    """

    log: CycleLog
    limit: float
    has_moved: bool

    def judge(self, metadata: RecordingMetadata) -> SignCheck:
        """What it says about signs and scales of the joint of `metadata`.

        Raises:
            SweepAborted: One is wrong, or the joint has not moved.
        """
        if not self.has_moved:
            raise SweepAborted(
                f"joint {metadata.joint!r} did not move under {self.limit:.3g} {metadata.torque_unit}: release the "
                "brake, or raise --check-torque"
            )
        samples = self.log.to_recording(next(iter(self.log.time_ns), 0), metadata, None)
        return check_signs(samples, torque_is_echo=metadata.torque_kind == "commanded")


def await_rest(runner: MotionRunner, travel: Travel, joint: str) -> None:
    """Let a joint that is not energised come to rest: one that still falls would answer a push with the wrong sign.

    Raises:
        SweepAborted: It does not.
        AdapterError: The bus failed.
    """
    still = _find_still(travel)
    for _ in range(round(PATIENCE / WHILE)):
        seen = runner.watch(WHILE).position
        if len(seen) > 1 and float(np.ptp(seen)) < still:
            return
    raise SweepAborted(f"joint {joint!r} does not come to rest within {PATIENCE:g} s, not energised: let it hang still")


def push_joint(runner: MotionRunner, context: SweepContext, travel: Travel) -> Push:
    """Let the torque of the joint rise until it has moved a little, towards the middle of its travel, then none at all.

    The joint comes to rest by itself where its friction does it: not energised at the end.

    Raises:
        ParameterError: Nothing is known that would hold the other joints of an arm.
        SweepAborted: The safety gate has tripped.
        AdapterError: The drive does not do as it is told.
    """
    limit = context.settings.check_torque * context.adapter.options.limits[context.joint].torque
    runner.start(context.make_check_loop(runner.period, runner.feedback.position))
    start, base, enough = runner.position, _compute_gravity_here(runner, context), ENOUGH * travel.length
    direction = 1.0 if start <= travel.middle else -1.0

    def torque(time: float) -> float | None:
        if abs(runner.position - start) > enough or time > RISE:
            return None
        return base + direction * limit * time / RISE

    log = runner.apply_torque(torque)
    has_moved = abs(runner.position - start) > enough
    if has_moved:
        _let_coast(runner, _find_still(travel), base)
    runner.stop()  # no loop may be closed over unknown signs
    return Push(log, limit, has_moved)


def _find_still(travel: Travel) -> float:
    """Distance that a joint at rest may seem to move [rad] or [m]."""
    return max(STILL * travel.length, COUNTS * travel.quantum)


def _let_coast(runner: MotionRunner, still: float, base: float) -> None:
    """Let go of a joint that the last torque has torn loose, at the torque `base`, as long as that slows it down.

    A drive's own loop would brake it with more torque than its limit. One that falls gains speed, and is left to the
    loop at once.

    Raises:
        SweepAborted: The safety gate has tripped.
        AdapterError: The bus failed.
    """
    before = inf
    for _ in range(round(LONGEST_COAST / GLIMPSE)):
        start = runner.position
        runner.apply_torque(lambda time: base if time < GLIMPSE else None)
        moved = abs(runner.position - start)
        if moved < still or moved > before + still:
            return
        before = moved


def _compute_gravity_here(runner: MotionRunner, context: SweepContext) -> float:
    body, here = context.body, np.array([runner.feedback.position])
    if body is None:
        return 0.0
    return float(body.torque(context.joint, here, 0.0 * here, 0.0 * here)[0])
