"""The picture of the data: each row is used or left out, and steps of channels are told."""

import numpy as np

from fricomp.recording.parts.data_chart import build_data_table, draw_data_chart, find_used_rows
from fricomp.recording.parts.parts import find_usable_parts
from fricomp.report import Line, Points
from fricomp.sim_bench.studies.logs.flaws import put_into
from fricomp.sim_bench.studies.logs.good_log import joint_log


def test_what_is_left_out_is_drawn_as_such() -> None:
    log = put_into(joint_log(24.0, 400.0, 3), ("rest", "outliers"), 3)
    usable = find_usable_parts(log)
    used = find_used_rows(usable)
    assert np.count_nonzero(~used) == sum(one.rows for one in usable.left_out)
    chart = draw_data_chart(usable, "data", "Data")
    line, points = chart.panels[0].marks
    assert isinstance(line, Line)
    assert isinstance(points, Points)
    assert np.isnan(line.y).any()
    assert points.x.size
    assert "left out" in chart.caption


def test_a_good_log_is_all_used() -> None:
    usable = find_usable_parts(joint_log(12.0, 400.0, 4))
    assert find_used_rows(usable).all()
    assert len(draw_data_chart(usable, "data", "Data").panels[0].marks) == 1


def test_steps_of_channels_are_told() -> None:
    log = put_into(joint_log(24.0, 400.0, 5), ("coarse_torque", "velocity_without_zero"), 5)
    rows = {row[0]: row for row in build_data_table(find_usable_parts(log)).rows}
    assert float(rows["torque"][2]) == 0.02
    assert "at rest" in rows["velocity"][3]
