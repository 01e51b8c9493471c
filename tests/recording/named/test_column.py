"""Names of columns as robots, middleware and people write them."""

from __future__ import annotations

import pytest

from fricomp.recording.named.column import read_column_name, read_column_unit, simplify_joint
from fricomp.recording.named.times.clock import find_stamps


@pytest.mark.parametrize(
    ("name", "channel", "joint", "unit"),
    [
        ("q_1", "position", "1", ""),
        ("Position7", "position", "7", ""),
        ("actual_q_0", "position", "0", ""),
        ("actual_qd_0", "velocity", "0", ""),
        ("tau_J:4", "torque", "4", ""),
        ("tau_J_d:3", "torque_command", "3", ""),
        ("dq_d:3", "velocity_reference", "3", ""),
        ("shoulder.effort", "torque", "shoulder", ""),
        ("/joint_states/elbow_joint/velocity", "velocity", "elbow_joint", ""),
        ("/joint_states/effort[2]", "torque", "2", ""),
        ("q_cmd[deg]:1", "position_reference", "1", "deg"),
        ("joint_1_position_deg", "position", "joint_1", "deg"),
        ("target_moment_2", "torque_command", "2", ""),
        ("motor_position_2", "motor_position", "2", ""),
        ("current_mA_3", "current", "3", "mA"),
        ("shoulder_pan_joint_torque_mNm", "torque", "shoulder_pan_joint", "mNm"),
        ("A1_torque_A", "torque", "A1", "A"),
        ("panda_finger_joint1.position", "position", "panda_finger_joint1", ""),
        ("drive_status.position", "position", "drive", ""),
        ("Drehzahl in min-1", "velocity", "", "rpm"),
        ("Winkel in Grad", "position", "", "deg"),
        ("speed_2 in grad/s", "velocity", "2", "deg/s"),
        ("Moment in Ncm", "torque", "", "Ncm"),
        ("position in encoder", "position", "", "counts"),
        ("speed [min⁻¹]", "velocity", "", "rpm"),
        ("qdd_2 (rad s^-2)", "acceleration", "2", ""),
        ("carriage speed [mm·s-1]", "velocity", "carriage", "mm/s"),
        ("Actual Current, Q axis [mA]", "current", "", "mA"),
        ("q_axis_2", "position", "axis_2", ""),
        ("motor_cur_mA", "current", "motor", "mA"),
        ("pos_cur", "position", "cur", ""),
    ],
)
def test_a_name_says_quantity_joint_and_unit(name: str, channel: str, joint: str, unit: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert (meaning.channel, meaning.joint, meaning.unit) == (channel, joint, unit)


@pytest.mark.parametrize(
    "name",
    [
        "time",
        "position_status",
        "drive.torque_enabled",
        "error.position",
        "gripper_width",
        "LuGre",
        "uart_cycle_hz",
        "ee_quat:1",
    ],
)
def test_other_names_say_nothing(name: str) -> None:
    assert read_column_name(name) is None


def test_what_was_measured_goes_before_a_controllers_feedback() -> None:
    measured, feedback = read_column_name("tau_measured:1"), read_column_name("tau_feedback:1")
    assert measured is not None
    assert feedback is not None
    assert measured.certainty > feedback.certainty


@pytest.mark.parametrize("name", ["joint_1", "J1", "1", "joint-01", "axis1"])
def test_words_for_a_joint_tell_none_from_another(name: str) -> None:
    assert simplify_joint(name) == "1"


@pytest.mark.parametrize(
    ("name", "channel", "joint", "unit"),
    [
        ("i_mA", "current", "", "mA"),
        ("I [A]", "current", "", ""),
        ("F [N]", "torque", "", "N"),
        ("x_mm", "position", "", "mm"),
        ("x_µm", "position", "", "um"),
        ("i_meas_mA", "current", "", "mA"),
        ("F_ist [N]", "torque", "", "N"),
        ("x_soll_mm", "position_reference", "", "mm"),
        ("u_cmd_Nm", "torque_command", "u", ""),
        ("elbow_rad", "position", "elbow", ""),
        ("elbow_rad_s", "velocity", "elbow", ""),
        ("elbow_Nm", "torque", "elbow", ""),
    ],
)
def test_a_unit_says_what_a_column_is_where_no_word_does(name: str, channel: str, joint: str, unit: str) -> None:
    assert read_column_name(name) is None
    meaning = read_column_unit(name)
    assert meaning is not None
    assert (meaning.channel, meaning.joint, meaning.unit) == (channel, joint, unit)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        *(
            ("pos_um", "um"),
            ("pos_urad", "urad"),
            ("q [µrad]", "urad"),
            ("position_µm", "um"),
            ("torque_kgf.cm", "kgf·cm"),
            ("torque_kg-cm", "kgf·cm"),
        ),
        *(
            ("torque_oz.in", "oz·in"),
            ("torque_in.lb", "in·lbf"),
            ("torque.lbf-in", "in·lbf"),
            ("torque_ft.lb", "ft·lbf"),
        ),
        *(("torque_mN.m", "mNm"), ("torque_N.m", ""), ("torque_kgf", "kgf")),
    ],
)
def test_a_unit_of_two_factors_is_no_unit_of_one(name: str, unit: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert (meaning.joint, meaning.unit) == ("", unit)


@pytest.mark.parametrize("name", ["phase_A", "battery_V", "T [°C]", "U [V]", "AI0 [V]", "load_cell_N", "error_rad"])
def test_a_unit_of_something_else_says_nothing(name: str) -> None:
    assert read_column_unit(name) is None


@pytest.mark.parametrize(
    "name",
    ["t_epoch_ms", "unix_ns", "host_ms", "timestamp_utc", "DateTime_UTC", "Uhrzeit", "tstamp", "ticks_us"],
)
def test_clocks_are_called_by_many_names(name: str) -> None:
    assert find_stamps([name, "tau"]) == [name]


@pytest.mark.parametrize("name", ["torque", "tau_s", "host", "theta", "lifetime", "temperature"])
def test_other_columns_are_no_clocks(name: str) -> None:
    assert find_stamps([name]) == []
