"""Names whose words are told by capital letters, torques in N·mm, and a motor whose quantities have a topic each."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(8.0, 125.0, 9)


def _write(path: Path, names: str, scale: float = 1.0) -> Path:
    rows = np.column_stack([LOG.time, LOG.position, scale * LOG.torque])
    np.savetxt(path, rows, delimiter=",", header=names, comments="", fmt="%.9f")
    return path


@pytest.mark.parametrize("time", ["SystemTime", "ElapsedTime", "RobotTime", "LogTimeStamp"])
def test_a_time_may_be_the_last_word_of_a_name_in_one(time: str, tmp_path: Path) -> None:
    (recording,) = read_named_log(_write(tmp_path / "log.csv", f"{time},JointPosition,JointTorque")).recordings
    assert recording.position == pytest.approx(LOG.position, abs=1e-8)
    assert recording.duration == pytest.approx(LOG.duration)


@pytest.mark.parametrize("name", ["Torque [N.mm]", "torque_Nmm", "Torque (N·mm)", "Torque [N*mm]"])
def test_newton_millimetres_are_known(name: str, tmp_path: Path) -> None:
    (recording,) = read_named_log(_write(tmp_path / "log.csv", f"t,q_rad,{name}", 1e3)).recordings
    assert recording.torque == pytest.approx(LOG.torque, abs=1e-8)


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        *(("torque_gcm", 1.0 / 9.80665e-5), ("torque_uNm", 1e6), ("tau_gf_cm", 1.0 / 9.80665e-5)),
        *(("torque_kgm", 1.0 / 9.80665), ("mNm_tau", 1e3), ("torque [gf·cm]", 1.0 / 9.80665e-5)),
    ],
)
def test_torques_of_small_and_of_large_motors_are_converted(name: str, factor: float, tmp_path: Path) -> None:
    (recording,) = read_named_log(_write(tmp_path / "log.csv", f"t,q_rad,{name}", factor)).recordings
    assert recording.torque == pytest.approx(LOG.torque, rel=1e-6, abs=1e-7)
    assert recording.metadata.torque_unit == "N·m"


def test_a_motor_whose_quantities_have_a_topic_each_is_asked_about_by_their_names(tmp_path: Path) -> None:
    mcap: Any = pytest.importorskip("mcap.writer")
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        writer = mcap.Writer(stream)
        writer.start()
        channels = {name: writer.register_channel(f"/motor/{name}", "json", 0) for name in ("position", "torque")}
        for row, t in enumerate(LOG.time):
            for name, channel in channels.items():
                data = json.dumps({"data": float(LOG.channels[name][row])}).encode()
                writer.add_message(channel, round(1e9 * t), data, round(1e9 * t))
        writer.finish()
    with pytest.raises(RecordingError, match=r"--channel /?.*position=/motor/position.data"):
        read_named_log(path)
    (recording,) = read_named_log(path, {"position": "/motor/position.data"}).recordings
    assert recording.torque == pytest.approx(LOG.torque)
