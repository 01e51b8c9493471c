"""A torque that holds another channel's numbers, or one number, is refused as what it is."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import check_recording

from ..joint_log import joint_log


@pytest.mark.parametrize("torque", [1.5, -0.2, 1e-4])
def test_one_torque_in_every_row_is_told_as_such_alone(torque: float) -> None:
    log = joint_log(20.0, 200.0, 3)
    errors = [
        one for one in check_recording(log.with_channels(torque=np.full(len(log), torque))) if one.severity == "error"
    ]
    assert [one.code for one in errors] == ["constant_torque"]
    assert f"{torque:g} in every row" in errors[0].message


def test_one_torque_of_a_joint_that_is_driven_one_way_is_none() -> None:
    log = joint_log(20.0, 200.0, 3)
    one_way = log.with_channels(position=np.asarray(log.time), torque=np.full(len(log), 0.3))
    assert "constant_torque" not in {one.code for one in check_recording(one_way)}


@pytest.mark.parametrize("channel", ["position", "position_reference"])
def test_the_numbers_of_another_channel_are_told(channel: str) -> None:
    log = joint_log(20.0, 200.0, 3)
    copied = log.with_channels(**{channel: log.position, "torque": log.position})
    assert "copied_torque" in {one.code for one in check_recording(copied)}
