"""An arm that is mounted otherwise than in its simulation is told as that, and not as links that are off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.examination import match_recordings
from fricomp.arm.words.corrections import say_gravity
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .moving_arm import record_arm

JOINTS = ("waist", "shoulder", "elbow")
_ARM = """<mujoco><option gravity="{0} {1} {2}"/><worldbody><body name="turret">
<inertial pos="0 0.02 0.05" mass="{3}" diaginertia="0.05 0.05 0.05"/><joint name="waist" axis="0 0 1" armature="0.4"/>
<body name="upper" pos="0 0 0.2"><inertial pos="0 0 0.2" mass="{4}" diaginertia="0.06 0.06 0.01"/>
<joint name="shoulder" axis="0 1 0" armature="0.4"/>
<body name="lower" pos="0 0 0.4"><inertial pos="0.02 0 0.15" mass="{5}" diaginertia="0.03 0.03 0.005"/>
<joint name="elbow" axis="0 1 0" armature="0.2"/></body></body></body></worldbody></mujoco>"""


def _write(folder: Path, gravity: tuple[float, ...], masses: tuple[float, ...] = (4.0, 3.0, 2.0)) -> Path:
    path = folder / f"{'_'.join(f'{one:.2f}' for one in (*gravity, *masses))}.xml"
    path.write_text(_ARM.format(*gravity, *masses))
    return path


def _record(folder: Path, gravity: tuple[float, ...], masses: tuple[float, ...] = (4.4, 2.8, 2.3)) -> list[Recording]:
    return record_arm(_write(folder, gravity, masses), duration=15.0, rate=100.0, joints=JOINTS)


@pytest.mark.parametrize("gravity", [(9.81, 0.0, 0.0), (0.0, 0.0, 9.81), (0.0, 6.94, -6.94), (-4.9, 0.0, -8.5)])
def test_an_arm_that_hangs_from_a_wall_or_a_ceiling_is_taken_so(tmp_path: Path, gravity: tuple[float, ...]) -> None:
    arm, _ = match_recordings(_record(tmp_path, gravity), _write(tmp_path, (0.0, 0.0, -9.81)))
    assert arm.remounted
    assert arm.gravity == pytest.approx(np.array(gravity), abs=0.8)
    assert "mounted otherwise" in say_gravity(arm.gravity.tolist(), ())[0]


def test_torques_without_gravity_are_compared_without(tmp_path: Path) -> None:
    arm, _ = match_recordings(_record(tmp_path, (0.0, 0.0, 0.0)), _write(tmp_path, (0.0, 0.0, -9.81)))
    assert not np.any(arm.gravity)
    assert "gravity taken off" in say_gravity(arm.gravity.tolist(), ())[0]


@pytest.mark.parametrize("masses", [(4.4, 2.8, 2.3), (4.0, 3.0, 5.0), (6.0, 1.5, 2.0)])
@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.81), (0.5, 0.3, -9.79)])
def test_links_that_are_off_and_a_base_off_its_level_are_no_other_mounting(
    tmp_path: Path, gravity: tuple[float, ...], masses: tuple[float, ...]
) -> None:
    arm, _ = match_recordings(_record(tmp_path, gravity, masses), _write(tmp_path, (0.0, 0.0, -9.81)))
    assert not arm.remounted


def test_a_joint_with_another_zero_is_no_other_mounting(tmp_path: Path) -> None:
    simulation = _write(tmp_path, (0.0, 0.0, -9.81))
    waist, shoulder, elbow = _record(tmp_path, (0.0, 0.0, -9.81))

    def turn(recording: Recording, angle: float) -> Recording:
        position: FloatArray = np.asarray(recording.position) + angle
        return recording.with_channels(position=position)

    arm, _ = match_recordings([waist, shoulder, turn(elbow, np.pi / 2.0)], simulation)
    assert not arm.remounted
    arm, _ = match_recordings([waist, turn(shoulder, np.pi / 2.0), elbow], simulation)
    assert not arm.remounted


def test_what_explains_as_much_as_another_mounting_is_told_with_it(tmp_path: Path) -> None:
    """From the ceiling, or with a shoulder that is half a turn off: gravity pulls the same way."""
    _, recording = match_recordings(_record(tmp_path, (0.0, 0.0, 9.81)), _write(tmp_path, (0.0, 0.0, -9.81)))
    assert [(one.joint, one.direction, abs(one.offset)) for one in recording.frames_instead] == [("shoulder", 1, np.pi)]
    assert "the same with shoulder" in say_gravity((0.0, 0.0, 9.81), recording.frames_instead)[0]
