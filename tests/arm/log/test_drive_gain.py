"""Recordings in amperes become torques where somebody says what an ampere is worth."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.arm.log.drive_gain import take_torques
from fricomp.errors import RecordingError
from fricomp.recording import Recording, RecordingMetadata

TIME = np.arange(10) / 10.0


def record(name: str, **metadata: object) -> Recording:
    return Recording(TIME, TIME, TIME, metadata=RecordingMetadata(joint=name, torque_unit="A", **metadata))  # type: ignore[arg-type]


def test_gains_come_from_the_user_the_metadata_or_torque_constant_and_gear() -> None:
    series = [
        record("a", extra={"drive_gain": 5.0}),
        record("b", extra={"drive_gain": 5.0}),
        record("c", gear_ratio=100.0, extra={"torque_constant": 0.07}),
    ]
    torques = take_torques(series, {"a": 2.0})
    assert [one.torque[-1] / TIME[-1] for one in torques] == pytest.approx([2.0, 5.0, 7.0])
    assert {one.metadata.torque_unit for one in torques} == {"N·m"}
    assert torques[0].current == pytest.approx(TIME)


def test_currents_without_a_gain_are_refused_with_the_line_to_write() -> None:
    with pytest.raises(RecordingError, match=r"of a, b is in A.*--gain a=\.\.\. --gain b=\.\.\."):
        take_torques([record("a"), record("b")], {})


def test_a_gain_of_no_joint_is_refused() -> None:
    with pytest.raises(RecordingError, match="one of the joints a"):
        take_torques([record("a")], {"z": 1.0})
