"""Names that the tools of drives write themselves, whose units their manuals state."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from .column import RAW_UNIT, ColumnMeaning

_TURNS = re.compile(
    r"(^|[./])(servo_stats\.position|servo_stats\.abs_position|encoder\.pos_estimate|pos_vel_mapper\.pos_(rel|abs))$"
)
"""Of moteus (its `servo_stats`) and of ODrive from firmware 0.5 on: positions in turns."""
_TURNS_A_SECOND = re.compile(r"(^|[./])(servo_stats\.velocity|encoder\.vel_estimate|pos_vel_mapper\.vel)$")

_KUKA = re.compile(r"(?:^|[./])A([IS])Pos\.(A\d)$")
"""Angles of the axes that a KUKA sends by its sensor interface, measured (`AI`) and asked for, in degrees."""

_MOTEUS = frozenset({"MODE", "POSITION", "VELOCITY", "TORQUE", "FAULT"})
"""Registers of a moteus, as its Python library names them."""
_VESC = frozenset({"ms_today", "erpm", "encoder_position", "q_axis_current"})
"""Columns of the logs that VESC Tool writes: degrees of an encoder, and the current that makes the torque."""
_MUJOCO = re.compile(r"(?:^|[./])actuator_force[\[_:.]?(\d*)\]?$")
"""What MuJoCo calls forces and torques of actuators alike."""


def with_vendor_unit(name: str, meaning: ColumnMeaning, beside: Collection[str] = ()) -> ColumnMeaning:
    """The meaning with the unit that a drive's own tool writes such a column in; others are as they were.

    Args:
        name: Of the column.
        meaning: What its words say.
        beside: Names of all columns.
    """
    if set(beside) >= _VESC and name in ("encoder_position", "q_axis_current"):
        return ColumnMeaning(meaning.channel, "", 3, "deg" if meaning.channel == "position" else "A")
    mujoco = _MUJOCO.search(name)
    if mujoco:
        return ColumnMeaning("torque", mujoco.group(1), meaning.certainty, "")
    path, _, register = name.rpartition(".")
    if register in ("POSITION", "VELOCITY") and {f"{path}.{one}".lstrip(".") for one in _MOTEUS} <= set(beside):
        return replace(meaning, unit="turns" if register == "POSITION" else "turns/s")
    if meaning.unit not in ("", RAW_UNIT):
        return meaning
    if meaning.channel == "position" and _TURNS.search(name):
        return replace(meaning, unit="turns", certainty=max(meaning.certainty, 0))
    kuka = _KUKA.search(name)
    if kuka:
        channel = "position" if kuka.group(1) == "I" else "position_reference"
        return ColumnMeaning(channel, kuka.group(2), meaning.certainty, "deg")
    if meaning.channel == "velocity" and _TURNS_A_SECOND.search(name):
        return replace(meaning, unit="turns/s", certainty=max(meaning.certainty, 0))
    return meaning
