"""What joints on one bus can do, once their drives have told it."""

from collections.abc import Sequence

from fricomp.errors import AdapterConfigurationError
from fricomp.joint import Capabilities, CommandMode, JointCapabilities

from ..bus_budget import BusBudget, can_frame_bits
from .configuration import CanOpenConfiguration
from .drive import CanOpenDrive
from .process_data import COMMAND_OBJECTS, STATE_OBJECTS

_MODES: tuple[CommandMode, ...] = ("torque", "velocity", "position")


def declare(
    configuration: CanOpenConfiguration,
    drives: Sequence[CanOpenDrive],
    modes: set[CommandMode],
    torque_limits: Sequence[float],
) -> Capabilities:
    """The capabilities of all joints.

    Args:
        configuration: Bus and joints.
        drives: Of the joints, with their scaling.
        modes: Cyclic modes that every drive has.
        torque_limits: Of the drives [N·m].

    Raises:
        AdapterConfigurationError: There is no such mode.
    """
    if not modes:
        raise AdapterConfigurationError("the drives have no cyclic synchronous mode in common (object 6502)")
    joints = tuple(
        JointCapabilities(
            joint.name,
            position_quantum=drive.scaling.position,
            velocity_quantum=drive.scaling.velocity,
            velocity_command_quantum=drive.scaling.velocity,
            torque_quantum=drive.scaling.torque,
            torque_limit=most,
            velocity_limit=drive.scaling.highest_velocity,
            reports_temperature=False,  # CiA 402 has no object for it
        )
        for joint, drive, most in zip(configuration.joints, drives, torque_limits, strict=True)
    )
    rates = {mode: highest_rate(configuration, mode) for mode in _MODES if mode in modes}
    return Capabilities(joints, tuple(rates), max(rates.values()), None, mode_rates=rates)


def highest_rate(configuration: CanOpenConfiguration, mode: CommandMode) -> float:
    """Highest rate in a mode: its command, both states of every drive, one SYNC, and the heartbeats [Hz]."""
    sizes = [sum(entry.n_bytes for entry in entries) for entries in (COMMAND_OBJECTS[mode], *STATE_OBJECTS)]
    bitrate, n_joints = configuration.bus.bitrate, len(configuration.joints)
    cycle = [can_frame_bits(0)] + [can_frame_bits(size) for size in sizes] * n_joints
    beats = n_joints / configuration.heartbeat + 1.0 / configuration.beat_period
    return BusBudget([bits / bitrate for bits in cycle], beats * can_frame_bits(1) / bitrate).highest_rate
