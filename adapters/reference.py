"""Velocity and position references on their way to a drive: finite, inside the limits, without jumps."""

from collections.abc import MutableSequence, Sequence
from math import inf, isfinite

from fricomp.control import JointLimits
from fricomp.joint import CommandMode, JointCommand


class ReferenceLimiter:
    """Keeps references inside the limits; a position reference moves no faster than the velocity limit.

    It moves by the time that has passed, and by one period at most: however often it is called, and however late.

    Args:
        limits: One for each joint, joint side.
        period: Control period [s].
    """

    def __init__(self, limits: Sequence[JointLimits], period: float) -> None:
        self._speeds = [limit.velocity for limit in limits]
        self._period_ns, self._moved_ns = round(period * 1e9), 0
        self._ranges = [limit.position or (-inf, inf) for limit in limits]
        self._held = [0.0] * len(limits)

    def start_at(self, position: Sequence[float], now_ns: int) -> bool:
        """Begin at `now_ns` [ns] from the measured positions [rad] or [m]; False if one is not known."""
        self._held[:], self._moved_ns = position, now_ns
        return all(map(isfinite, position))

    def limit(self, command: JointCommand, mode: CommandMode, out: JointCommand, now_ns: int) -> str | None:
        """Fill the references of `out` that `mode` uses at `now_ns` [ns]; what is wrong with them in words, or None.

        Nothing is filled in unless all entries are finite.
        """
        wanted = command.velocity if mode == "velocity" else command.position
        if len(wanted) != len(self._held):
            return f"{len(wanted)} {mode} references for {len(self._held)} joints"
        try:
            well = all(map(isfinite, wanted))
        except (TypeError, OverflowError) as error:
            return f"{mode} reference {list(wanted)}: {error}"
        if not well:
            return f"{mode} reference is not finite: {list(wanted)}"
        if mode == "velocity":
            for joint, speed in enumerate(self._speeds):
                out.velocity[joint] = _clamp(wanted[joint], -speed, speed)
        else:
            self._step(wanted, out.position, now_ns)
        return None

    def _step(self, wanted: Sequence[float], out: MutableSequence[float], now_ns: int) -> None:
        held, elapsed = self._held, min(max(now_ns - self._moved_ns, 0), self._period_ns) * 1e-9
        self._moved_ns = now_ns
        for joint, speed in enumerate(self._speeds):
            step, target = speed * elapsed, _clamp(wanted[joint], *self._ranges[joint])
            held[joint] = out[joint] = _clamp(target, held[joint] - step, held[joint] + step)


def _clamp(value: float, low: float, high: float) -> float:
    return low if value < low else high if value > high else value
