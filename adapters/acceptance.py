"""What an adapter refuses before anything moves: limits that drives cannot keep, rates beyond the bus."""

from collections.abc import Callable, Sequence
from typing import NoReturn

from fricomp.control import JointLimits, SafetyGate
from fricomp.control.number import is_number
from fricomp.errors import AdapterConfigurationError, AdapterError, FricompError, ParameterError
from fricomp.joint import Capabilities, CommandMode, JointCapabilities, Watchdog

from .options import AdapterOptions

__all__ = ["check_counts", "check_limits", "check_rate", "check_waiver", "check_watchdog", "make_gate", "raise_own"]

# Limits that come from rounded data sheets may miss the drive's own value by a hair.
ROUNDING = 1e-6


def check_counts(n_joints: int, **given: Sequence[object]) -> None:
    """One entry of everything for each joint.

    Raises:
        AdapterConfigurationError: It is not so.
    """
    for what, entries in given.items():
        if not isinstance(entries, Sequence) or isinstance(entries, str | bytes):
            raise AdapterConfigurationError(f"{what} must be a sequence of one entry for each joint, got {entries!r}")
        if len(entries) != n_joints:
            raise AdapterConfigurationError(f"{len(entries)} {what} given for {n_joints} joints: give one for each")


def check_limits(joints: Sequence[JointCapabilities], limits: Sequence[JointLimits]) -> None:
    """No limit beyond what the drive can do or report: torque would saturate unseen, an overspeed go unnoticed.

    Raises:
        AdapterConfigurationError: A limit is beyond the drive's.
    """
    for joint, limit in zip(joints, limits, strict=True):
        if not isinstance(limit, JointLimits):
            raise AdapterConfigurationError(f"joint {joint.name!r}: its limits must be JointLimits, got {limit!r}")
        for what, wanted, most in (
            ("torque", limit.torque, joint.torque_limit),
            ("velocity", limit.velocity, joint.velocity_limit),
        ):
            if wanted > most * (1.0 + ROUNDING):
                raise AdapterConfigurationError(
                    f"joint {joint.name!r}: {what} limit {wanted:g} is beyond the drive's {most:g}: lower the limit"
                )
        if limit.temperature is not None and not joint.reports_temperature:
            raise AdapterConfigurationError(
                f"joint {joint.name!r}: the drive does not report its temperature, so that nobody would notice "
                f"{limit.temperature:g} °C: leave the temperature limit out, and watch the motor by other means"
            )
        if joint.position_limits is not None and limit.position is not None:
            low, high = joint.position_limits
            if limit.position[0] < low - ROUNDING or limit.position[1] > high + ROUNDING:
                raise AdapterConfigurationError(
                    f"joint {joint.name!r}: position limits {limit.position} are beyond the drive's ({low:g}, {high:g})"
                )


def check_rate(offered: Capabilities, mode: CommandMode, period: float) -> None:
    """Mode and period [s] that the drives and the bus can serve.

    Raises:
        AdapterConfigurationError: They cannot.
    """
    if mode not in offered.modes:
        raise AdapterConfigurationError(f"mode {mode!r} is not offered; this drive has {', '.join(offered.modes)}")
    if not (is_number(period, 0.0) and period > 0.0):
        raise AdapterConfigurationError(f"the period must be a finite positive number [s], got {period!r}")
    highest = offered.rate_in(mode)
    if 1.0 / period > highest * (1.0 + 1e-9):
        raise AdapterConfigurationError(
            f"a period of {period} s is {1.0 / period:.0f} Hz; {len(offered.joints)} joints on this bus carry at most "
            f"{highest:.0f} Hz in {mode} mode: lower the rate, or spread the joints over more buses"
        )


def check_watchdog(watchdog: Watchdog | None, period: float) -> None:
    """A watchdog must outlast two periods [s], or one late cycle stops the joints.

    Raises:
        AdapterConfigurationError: It is shorter.
    """
    if watchdog is not None and watchdog.timeout < 2.0 * period:
        raise AdapterConfigurationError(
            f"a watchdog of {watchdog.timeout:g} s is shorter than two periods of {period:g} s: "
            f"lengthen it or raise the rate"
        )


def make_gate(
    options: AdapterOptions,
    joints: Sequence[JointCapabilities],
    mode: CommandMode,
    period: float,
    describe_faults: Callable[[Sequence[int]], str],
) -> SafetyGate:
    """The gate for these options; its torque is watched where the drive closes a loop of its own.

    Raises:
        AdapterConfigurationError: `ramp_time` or `stale_after` is out of its domain.
    """
    try:
        return SafetyGate(
            options.limits,
            period=period,
            ramp_time=options.ramp_time,
            stale_after=options.stale_after,
            watch_torque=mode != "torque",
            quanta=[(joint.position_quantum, joint.velocity_quantum) for joint in joints],
            describe_faults=describe_faults,
            names=[joint.name for joint in joints],
        )
    except ParameterError as error:
        raise AdapterConfigurationError(str(error)) from error


def check_waiver(options: AdapterOptions) -> None:
    """Doing without a watchdog is said by True and nothing else.

    Raises:
        AdapterConfigurationError: It is said otherwise.
    """
    if not isinstance(options.allow_no_watchdog, bool):
        raise AdapterConfigurationError(f"allow_no_watchdog must be True or False, got {options.allow_no_watchdog!r}")


def raise_own(error: BaseException) -> NoReturn:
    """Raise `error` as it is if it is one of this library's or no ordinary exception, else as an `AdapterError`.

    Raises:
        AdapterError: `error` was foreign.
    """
    if isinstance(error, FricompError) or not isinstance(error, Exception):
        raise error
    raise AdapterError(f"the driver failed: {error!r}") from error
