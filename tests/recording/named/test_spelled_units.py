"""Units that are words of a name, in capitals, spelled out or in brackets, and columns of another current or angle."""

from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording.named.column import read_column_name, read_column_unit
from fricomp.recording.named.log import read_named_log

TIME = np.arange(2000) / 200.0
POSITION = 0.8 * np.sin(2.1 * TIME)
VELOCITY = 0.8 * 2.1 * np.cos(2.1 * TIME)
TORQUE = 0.3 * np.tanh(VELOCITY / 0.01) + 0.2 * VELOCITY
DEG, TURN = np.pi / 180.0, 2.0 * np.pi
POUND_FORCE = 4.4482216152605


def _write(path: Path, **columns: object) -> Path:
    names = list(columns)
    rows = np.column_stack([np.broadcast_to(np.asarray(one, dtype=float), TIME.shape) for one in columns.values()])
    path.write_text("\n".join([",".join(names), *(",".join(f"{x:.9g}" for x in row) for row in rows)]) + "\n")
    return path


@pytest.mark.parametrize(
    ("position", "velocity", "torque"),
    [
        (("posDeg", DEG), ("velDegPerSec", DEG), ("torqueNm", 1.0)),
        (("positionDegrees", DEG), ("velocityRadPerSec", 1.0), ("torqueNewtonMeters", 1.0)),
        (("jointPosRad", 1.0), ("jointVelRadS", 1.0), ("jointTorqueMNm", 1e-3)),
        (("position_revs", TURN), ("velocity_revs_per_sec", TURN), ("torque_milli_newton_meters", 1e-3)),
        (("Position (rotations)", TURN), ("Velocity (rotations/s)", TURN), ("Torque (ft-lbs)", 0.3048 * POUND_FORCE)),
        (("pos_cdeg", DEG / 100.0), ("vel_mrad_s", 1e-3), ("Torque [in-lbs]", 0.0254 * POUND_FORCE)),
        (("angle_in_degrees", DEG), ("speed_in_rad_per_s", 1.0), ("torque_in_N_mm", 1e-3)),
        (("posMDeg", DEG / 1e3), ("velocity[mdeg/s]", DEG / 1e3), ("torque_millinewtonmeters", 1e-3)),
        (("q_m_deg", DEG), ("dq_m_deg_s", DEG), ("tau_m_in_lb", 0.0254 * POUND_FORCE)),
        (("angleDegFiltered", DEG), ("speedRpm", TURN / 60.0), ("torque_foot_pounds", 0.3048 * POUND_FORCE)),
    ],
)
def test_a_unit_in_words_is_that_of_its_column(
    tmp_path: Path, position: tuple[str, float], velocity: tuple[str, float], torque: tuple[str, float]
) -> None:
    own = {
        name: values / one
        for (name, one), values in zip((position, velocity, torque), (POSITION, VELOCITY, TORQUE), strict=True)
    }
    (read,) = read_named_log(_write(tmp_path / "log.csv", time_s=TIME, **own)).recordings
    np.testing.assert_allclose(read.position, POSITION, atol=1e-6)
    np.testing.assert_allclose(np.asarray(read.velocity), VELOCITY, atol=1e-6)
    np.testing.assert_allclose(read.torque, TORQUE, atol=1e-6)


@pytest.mark.parametrize(
    "name", ["torque (cd/yd)", "Torque (Nm/A)", "pos_0.1deg", "Position (native units)", "Position (clicks)"]
)
def test_a_unit_that_nobody_knows_is_asked_for(tmp_path: Path, name: str) -> None:
    is_position = name.lower().startswith("pos")
    names = (name, "torque") if is_position else ("q", name)
    path = _write(tmp_path / "log.csv", **{"time_s": TIME, names[0]: POSITION, names[1]: TORQUE})
    with pytest.raises(RecordingError, match="is not known"):
        read_named_log(path)


@pytest.mark.parametrize(
    ("name", "channel", "joint", "unit"),
    [
        ("tau_m_Nm", "torque", "m", ""),
        ("current_q", "current", "", ""),
        ("motor.current.q", "current", "motor", ""),
        ("q_current", "current", "", ""),
        ("mech_angle", "position", "", ""),
        ("/model/elbow/torque", "torque", "elbow", ""),
    ],
)
def test_letters_and_words_that_are_no_unit_stay_what_they_are(name: str, channel: str, joint: str, unit: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert (meaning.channel, meaning.joint, meaning.unit) == (channel, joint, unit)


@pytest.mark.parametrize(
    "name", ["current_d", "voltage_q", "motor.voltage.q", "bus_current", "i_bus", "battery_current", "current_in",
             "elec_angle", "tau_ff", "gravity_torque", "friction_torque", "model_torque"]
)  # fmt: skip
def test_a_column_that_is_no_measured_channel_of_the_joint_is_none(name: str) -> None:
    assert read_column_name(name) is None


def test_the_current_of_a_motor_is_taken_beside_that_of_its_supply(tmp_path: Path) -> None:
    supply = np.abs(TORQUE * VELOCITY) / 24.0
    path = _write(tmp_path / "log.csv", time=TIME, q=POSITION, dq=VELOCITY, bus_current=supply, motor_current=TORQUE)
    (read,) = read_named_log(path).recordings
    np.testing.assert_allclose(read.torque, TORQUE, atol=1e-6)


@pytest.mark.parametrize("name", ["motorCurrentMilliAmps", "iq_mAmps", "current_milliamps", "i_mA"])
def test_a_current_in_thousandths_is_one_however_it_is_spelled(tmp_path: Path, name: str) -> None:
    (read,) = read_named_log(_write(tmp_path / "log.csv", time=TIME, q=POSITION, **{name: 1e3 * TORQUE})).recordings
    np.testing.assert_allclose(read.torque, TORQUE, atol=1e-6)
    assert read.metadata.torque_unit == "A"


@pytest.mark.parametrize(("name", "one"), [("Time (h)", 3600.0), ("time-ms", 1e-3), ("t.sec", 1.0), ("time_min", 60.0)])
def test_the_unit_of_a_time_is_read_behind_any_mark(tmp_path: Path, name: str, one: float) -> None:
    path = tmp_path / "log.csv"
    rows = (f"{t / one!r},{q:.9g},{tau:.9g}" for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True))
    path.write_text("\n".join([f"{name},q,tau", *rows]) + "\n")
    (read,) = read_named_log(path).recordings
    np.testing.assert_allclose(read.time - read.time[0], TIME, atol=1e-6)


def test_decimal_commas_between_commas_are_read(tmp_path: Path) -> None:
    rows = (",".join(f"{x:.6f}".replace(".", ",") for x in row) for row in zip(TIME, POSITION, TORQUE, strict=True))
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["t,q,tau", *rows]) + "\n")
    (read,) = read_named_log(path).recordings
    np.testing.assert_allclose(read.position, POSITION, atol=1e-6)
    np.testing.assert_allclose(read.torque, TORQUE, atol=1e-6)


def test_no_name_of_a_column_stops_its_reading() -> None:
    parts = [
        *"[]()_-./% °·iqd1",
        "in",
        "m",
        "pos",
        "Deg",
        "per",
        "s",
        "milli",
        "Nm",
        "lb",
        "current",
        "ü",
        "角度",
        "0.1",
        "A",
    ]
    assert read_column_name("menüi1") is None
    rng = np.random.default_rng(5)
    for count in rng.integers(0, 8, 3000):
        name = "".join(rng.choice(parts, count))
        for read in (read_column_name, read_column_unit):
            meaning = read(name)
            assert meaning is None or meaning.channel


def test_the_least_of_a_channel_is_neither_a_joint_nor_minutes() -> None:
    assert read_column_name("pos_min_deg") is None
