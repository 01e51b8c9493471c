"""A motion from a file: where it is recorded, and what is refused before anything moves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration.sweep import (
    MotionFile,
    RunFolder,
    Sweep,
    SweepContext,
    SweepData,
    SweepSettings,
    at_rows_rate,
    channels_of,
    fit_into,
    load_sweep,
    read_motion,
    record_motion,
    travel_now,
)
from fricomp.calibration.sweep.planning.plan import Travel
from fricomp.errors import ParameterError
from fricomp.recording import Recording
from fricomp.sim_bench.stand_in import SimulatedJointAdapter, default_joint, packaged_model

TRAVEL = Travel(-1.0, 2.0, 5.0)


def _write(path: Path, position: float | None, suffix: str = "") -> Path:
    """A sine of 0.2 rad in one direction from `position`, and back."""
    time = np.arange(0.0, 4.0, 0.01)
    columns = {"time": time, f"velocity{suffix}": 0.1 * np.pi * np.sin(np.pi * time)}
    if position is not None:
        columns[f"position{suffix}"] = position + 0.1 * (1.0 - np.cos(np.pi * time))
    header, rows = ",".join(columns), np.column_stack(list(columns.values()))
    np.savetxt(path, rows, delimiter=",", header=header, comments="")
    return path


def _record(context: SweepContext, folder: RunFolder, file: Path) -> tuple[Recording, float]:
    with folder.open_writer(context.metadata(), channels_of(context)) as writer:
        sweep = Sweep(context, writer, SweepData())
        sweep.prepare()
        distance = record_motion(sweep, read_motion(file))
        sweep.finish()
    ((_, samples),) = load_sweep(folder.recording).of_kind("motion")
    return samples, distance


@pytest.mark.parametrize("suffix", ["", "_reference"])
@pytest.mark.parametrize("position", [0.9, -1.3])
def test_a_motion_is_recorded_where_its_file_says(
    context: SweepContext, folder: RunFolder, tmp_path: Path, position: float, suffix: str
) -> None:
    samples, distance = _record(context, folder, _write(tmp_path / "motion.csv", position, suffix))
    planned = position + 0.1 * (1.0 - np.cos(np.pi * (samples.time - samples.time[0])))
    assert samples.position[0] == pytest.approx(position, abs=2e-3)
    assert np.max(np.abs(samples.position - planned)) < 4e-3
    assert distance == pytest.approx(np.max(np.abs(samples.position - planned)), abs=1e-4)


def test_a_motion_without_positions_is_recorded_in_the_middle(
    context: SweepContext, folder: RunFolder, tmp_path: Path
) -> None:
    samples, _ = _record(context, folder, _write(tmp_path / "motion.csv", None))
    middle = 0.5 * (samples.position.min() + samples.position.max())
    assert middle == pytest.approx(context.travel().middle, abs=4e-3)


@pytest.mark.parametrize(
    ("position", "words"), [(1.9, "ends 0.1 above it"), (-1.25, "ends 0.25 below it"), (1.9, "leave out that column")]
)
def test_a_motion_that_leaves_the_travel_is_refused_by_how_much(tmp_path: Path, position: float, words: str) -> None:
    motion = read_motion(_write(tmp_path / "motion.csv", position))
    with pytest.raises(ParameterError, match=words):
        fit_into(motion, TRAVEL)
    centred = fit_into(replace(motion, start=None), TRAVEL)
    assert centred == pytest.approx(0.4, abs=1e-3)


def test_a_velocity_that_does_not_lead_along_the_positions_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "motion.csv"
    file.write_text("time,velocity,position\n0,0,20\n1,0.5,48.6\n2,0,77.3\n")  # degrees
    with pytest.raises(ParameterError, match=r"56\.8 apart after 2 s"):
        read_motion(file)


def test_positions_that_are_not_finite_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "motion.csv"
    file.write_text("time,velocity,position\n0,0,0\n1,0.5,nan\n")
    with pytest.raises(ParameterError, match="finite"):
        read_motion(file)


def test_the_travel_of_a_joint_that_turns_freely_lies_about_where_it_is(tmp_path: Path) -> None:
    free = tmp_path / "free.xml"
    free.write_text(packaged_model("default_joint").read_text().replace('range="-3 3" limited="true"', ""))
    joint = default_joint(seed=3)
    turned = replace(joint, mjcf=free, joints=(replace(joint.joints[0], position=7.0),))
    with SimulatedJointAdapter(turned) as adapter:
        travel = travel_now(SweepContext(adapter, 0, SweepSettings()))
        assert travel.middle == pytest.approx(7.0, abs=1e-2)
        assert not adapter.enabled


def test_the_loop_is_as_fast_as_the_rows_of_the_file_where_it_can(context: SweepContext) -> None:
    rates = {}
    for step in (1.0, 0.002, 0.0014, 0.001, 0.0001):
        time = np.asarray(np.arange(3) * step, dtype=np.float64)
        rates[step] = at_rows_rate(context, MotionFile(time, np.zeros(3))).settings.rate
    assert rates == pytest.approx({1.0: 500.0, 0.002: 500.0, 0.0014: 500.0, 0.001: 1000.0, 0.0001: 1000.0})
