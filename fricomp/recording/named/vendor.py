"""Names that the tools of drives write themselves, whose units their manuals state."""

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

import numpy as np

from fricomp.recording.unit_word import UNKNOWN_UNIT, find_unit_words, unit_for
from fricomp.recording.validity import Samples

from .column import RAW_UNIT, ColumnMeaning, read_column_name, without_address
from .device_unit import with_device_unit

_TURNS = re.compile(r"(^|[./])servo_stats\.(abs_)?position$")
"""Of moteus (its `servo_stats`): positions in turns."""
_TURNS_A_SECOND = re.compile(r"(^|[./])servo_stats\.velocity$")

_ODRIVE = re.compile(
    r"axis\d[._](.*[._])?pos_(estimate|rel|abs)$|encoder\.pos_estimate$|pos_vel_mapper\.pos|(^|[._])Iq_measured$"
)
"""A column that ODrive alone has: its positions below an axis, from firmware 0.5 on, or its measured current."""
_OF_ODRIVE = {
    **dict.fromkeys(("pos_estimate", "pos_rel", "pos_abs"), ("position", "turns")),
    **dict.fromkeys(("vel_estimate", "pos_vel_mapper.vel"), ("velocity", "turns/s")),
    **dict.fromkeys(("input_pos", "pos_setpoint"), ("position_reference", "turns")),
    **dict.fromkeys(("input_vel", "vel_setpoint"), ("velocity_reference", "turns/s")),
    **dict.fromkeys(("input_torque", "torque_setpoint"), ("torque_command", "")),
    "Iq_measured": ("current", "A"),
    "torque_estimate": ("torque", ""),
}
"""Channel and unit of what the last words of its columns say."""

_LOOP = re.compile(r"(?:^|[./ ])([PVI])L\.(FB|CMD)(?![A-Za-z0-9])")
"""Of Kollmorgen's drives: position, velocity and current loop, what comes back and what is asked for."""
_OF_LOOP = {
    "P": ("position", "position_reference", RAW_UNIT),
    "V": ("velocity", "velocity_reference", "rpm"),
    "I": ("current", "", "A"),
}
"""Channels of a loop's feedback and command, and the unit of both where the name states none."""
_SERVO_GUIDE = {"POSF": "position", "POSFB": "position", "SPEED": "velocity", "TCMD": "torque"}
"""Channels of Fanuc's Servo Guide, beside its command of the velocity or the torque."""
_SERVO_GUIDE_ASKED = ("TCMD", "VCMD")
_KUKA_AXIS = re.compile(r"(?:^|[./$])AXIS_?ACT[\[_. ]*(A?\d)\]?$", re.IGNORECASE)
"""The system variable of a KUKA with the angles of its axes, in degrees."""
_ACTUATOR = re.compile(r"(?:^|[./])qfrc_actuator[\[_:.]?(\w*)\]?$")
"""What MuJoCo calls the torque of all actuators at a joint."""
_PRIMITIVE = re.compile(r"(.+[._/ ])([wt])$")
"""Angular velocity and torque of a joint of Simscape, beside its angle `q`; Drake and others have `w` as well."""
_POLICY = re.compile(r"(^|\.)(observation\.state|action)\.[^/]*\.pos$")
"""Positions of LeRobot: degrees, or parts of a range in per cent, as the robot was set up."""

_PHOENIX = re.compile(r"(?:^|/)(?:Phoenix6|TalonFXS?|CANcoder)\b[^/]*/.*\b(Position|Velocity)$")
"""Signals of CTRE's Phoenix 6: rotations, and rotations a second."""

_ROTATIONS = re.compile(r"[ _.]rot$", re.IGNORECASE)
"""A unit behind the word of a position, unless another column is of a joint of that name: `pos_rot`."""

_LARGEST_RAD = 8.0
"""Of such a position, above which it is not in rad."""

_KUKA = re.compile(r"(?:^|[./])A([IS])Pos\.(A\d)$")
"""Angles of the axes that a KUKA sends by its sensor interface, measured (`AI`) and asked for, in degrees."""

_MOTEUS = frozenset({"MODE", "POSITION", "VELOCITY", "TORQUE", "FAULT"})
"""Registers of a moteus, as its Python library names them."""
_VESC = frozenset({"ms_today", "erpm", "encoder_position", "q_axis_current"})
"""Columns of the logs that VESC Tool writes: degrees of an encoder, and the current that makes the torque."""
_MUJOCO = re.compile(r"(?:^|[./])actuator_force[\[_:.]?(\d*)\]?$")
"""What MuJoCo calls forces and torques of actuators alike."""
_GAZEBO = re.compile(r"(?:^|.*\.)([^.]+)\.axis1\.(?:position|velocity|force)$")
"""Motion of a joint of Gazebo, whose torque is called a force too."""


_MOTEUS_FIELDS = frozenset({"mode", "position", "velocity", "torque"})
_MOTEUS_OWN = frozenset({"q_current", "d_current", "abs_position", "trajectory_complete", "home_state"})
"""Fields of a moteus' answer, as its C++ library names them; of the latter some."""
_ODRIVE_FIELDS = frozenset({"pos_estimate", "vel_estimate"})


def find_drive_of_turns(column: str, beside: Iterable[str]) -> str:
    """The drive whose fields are called as a position and the columns beside it, and are turns; empty where none is.

    Args:
        column: Of the position, called so without a path.
        beside: Names of all columns.
    """
    names = set(beside)
    if column == "position" and names >= _MOTEUS_FIELDS and names & _MOTEUS_OWN:
        return "moteus"
    return "ODrive" if column == "pos_estimate" and names >= _ODRIVE_FIELDS else ""


def read_vendor_name(name: str, beside: Mapping[str, Samples]) -> ColumnMeaning | None:
    """What a column holds whose name says it to those who know the program alone; None of any other.

    Args:
        name: Of the column.
        beside: All columns by name.
    """
    said = find_unit_words(name, -1)
    loop = _LOOP.search(name)
    if loop:
        measured, asked, usual = _OF_LOOP[loop.group(1)]
        channel = measured if loop.group(2) == "FB" else asked
        unit = unit_for(measured, said[0].unit) if said else usual
        return ColumnMeaning(channel, name[: loop.start()], 2, unit) if channel else None
    word = re.split(r"[\[(\s]", name)[0]
    if word in _SERVO_GUIDE and any(one.startswith(_SERVO_GUIDE_ASKED) for one in beside):
        channel = _SERVO_GUIDE[word]
        return ColumnMeaning(channel, "", 2, unit_for(channel, said[0].unit) if said else UNKNOWN_UNIT)
    axis = _KUKA_AXIS.search(name)
    if axis:
        return ColumnMeaning("position", axis.group(1), 2, "deg")
    primitive = _PRIMITIVE.match(name)
    if primitive and f"{primitive.group(1)}q" in beside and f"{primitive.group(1)}w" in beside:
        return ColumnMeaning("velocity" if primitive.group(2) == "w" else "torque", primitive.group(1)[:-1], 1, "")
    actuator = _ACTUATOR.search(name)
    if actuator:
        return ColumnMeaning("torque", actuator.group(1), 1, "")
    return _read_odrive_name(name, beside)


def _read_simulated(name: str, meaning: ColumnMeaning, beside: Collection[str]) -> ColumnMeaning | None:
    """What MuJoCo and Gazebo write of a joint, whose torque they call a force too; None of any other column."""
    mujoco, gazebo = _MUJOCO.search(name), _GAZEBO.match(name)
    if mujoco:
        return ColumnMeaning("torque", mujoco.group(1), meaning.certainty, "")
    if gazebo and f"{name.rpartition('.')[0]}.force" in beside:
        return replace(meaning, joint=gazebo.group(1), unit="")
    return None


def _as_turns(name: str, meaning: ColumnMeaning, beside: Iterable[str]) -> ColumnMeaning | None:
    """A position that a moteus or a word behind it says to be in turns; None of any other."""
    if _TURNS.search(name):
        return replace(meaning, unit="turns", certainty=max(meaning.certainty, 0))
    is_unit = _ROTATIONS.search(name) and not _is_joint(meaning.joint, beside)
    return replace(meaning, joint="", unit="turns") if is_unit else None


def _is_joint(called: str, beside: Iterable[str]) -> bool:
    """Whether another quantity than a position is of a joint that is called so."""
    meanings = (read_column_name(one) for one in beside)
    return any(one is not None and one.joint == called and not one.channel.startswith("position") for one in meanings)


def _read_odrive_name(name: str, beside: Iterable[str]) -> ColumnMeaning | None:
    said = next((one for one in _OF_ODRIVE if re.search(rf"(^|[./_]){re.escape(one)}$", name)), None)
    if said is None or not any(_ODRIVE.search(one) for one in beside):
        return None
    channel, unit = _OF_ODRIVE[said]
    axis = re.search(r"axis\d+", name)
    return ColumnMeaning(channel, axis.group() if axis else "", 2, unit)


def with_vendor_unit(name: str, meaning: ColumnMeaning, beside: Mapping[str, Samples]) -> ColumnMeaning:
    """The meaning with the unit that a drive's own tool writes such a column in; others are as they were.

    Args:
        name: Of the column.
        meaning: What its words say.
        beside: All columns by name.
    """
    if set(beside) >= _VESC and name in ("encoder_position", "q_axis_current"):
        return ColumnMeaning(meaning.channel, "", 3, "deg" if meaning.channel == "position" else "A")
    simulated = _read_simulated(name, meaning, beside)
    if simulated is not None:
        return simulated
    path, _, register = without_address(name).rpartition(".")
    if register in ("POSITION", "VELOCITY") and {f"{path}.{one}".lstrip(".") for one in _MOTEUS} <= set(
        map(without_address, beside)
    ):
        return replace(meaning, unit="turns" if register == "POSITION" else "turns/s")
    if meaning.unit not in ("", RAW_UNIT):
        return meaning
    if meaning.channel == "position" and (turns := _as_turns(name, meaning, beside)) is not None:
        return turns
    if meaning.channel == "position" and _POLICY.search(name) and np.nanmax(np.abs(beside[name])) > _LARGEST_RAD:
        return replace(meaning, unit=UNKNOWN_UNIT)
    phoenix = _PHOENIX.search(name)
    if phoenix and not meaning.unit:
        return replace(meaning, unit="turns" if phoenix.group(1) == "Position" else "turns/s")
    kuka = _KUKA.search(name)
    if kuka:
        channel = "position" if kuka.group(1) == "I" else "position_reference"
        return ColumnMeaning(channel, kuka.group(2), meaning.certainty, "deg")
    if meaning.channel == "velocity" and _TURNS_A_SECOND.search(name):
        return replace(meaning, unit="turns/s", certainty=max(meaning.certainty, 0))
    return with_device_unit(name, meaning, beside)
