"""The sweep on the stand-in: every part of it, in some seconds of simulated time."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.adapters import AdapterOptions
from fricomp.calibration.identification import save_identification
from fricomp.calibration.sweep import (
    Calibration,
    CalibrationRequest,
    MotionFile,
    RigidBody,
    RunFolder,
    Sweep,
    SweepContext,
    SweepData,
    analyse_sweep,
    calibrate,
    identify_recorded,
    load_sweep,
    read_motion,
    record_motion,
)
from fricomp.calibration.sweep.analysis.block import BlockLabel
from fricomp.calibration.sweep.calibrate import channels_of
from fricomp.calibration.sweep.motion.log import CycleLog
from fricomp.calibration.sweep.report.check import calibration_checks, compensation_check
from fricomp.calibration.sweep.report.report import write_calibration_report
from fricomp.calibration.sweep.sweep import Progress
from fricomp.control import JointLimits
from fricomp.errors import OutputError, ParameterError, SafetyTrip, SweepAborted
from fricomp.folder_lock import LOCK_FILE
from fricomp.recording import Recording, read_recording
from fricomp.sim_bench.stand_in import (
    DEFAULT_LAW,
    NO_DISTURBANCE,
    SimulatedJointAdapter,
    default_joint,
    packaged_model,
    two_link_arm,
)


def _interrupt_at(plateau: int, part: str = "sweeping") -> Progress:
    """Ctrl-C when the plateau of this number within a part of the sweep would start."""
    seen = 0

    def report(text: str, done: float) -> None:
        nonlocal seen
        seen += text.startswith(part) and text.endswith("/s")
        if seen > plateau:
            raise KeyboardInterrupt

    return report


def _errors(calibration: Calibration) -> dict[str, float]:
    truth, found = DEFAULT_LAW.parameters(), calibration.estimate.result.parameters
    return {name: abs(found[name] / truth[name] - 1.0) for name in found}


def test_a_short_sweep_recovers_all_eight_parameters(context: SweepContext, folder: RunFolder) -> None:
    calibration = calibrate(context, folder, folder.request.options)
    assert len(calibration.estimate.result.parameter_names) == 8
    assert max(_errors(calibration).values()) < 0.02
    assert not [c for c in calibration_checks(calibration) if c.outcome in ("warning", "failed")]
    assert calibration.analysis.offset.value == pytest.approx(0.005 * 0.175, abs=4e-4)
    for direction, static in ((1, 0.6), (-1, 0.7)):
        measured = calibration.analysis.static_torque(direction)
        assert measured is not None
        assert measured.value == pytest.approx(static, rel=0.03)


def test_a_sweep_that_is_recorded_is_identified_again_and_nothing_moves(
    context: SweepContext, folder: RunFolder
) -> None:
    first = calibrate(context, folder, folder.request.options)
    kept = folder.recording.read_bytes()
    folder.note("recorded")
    again = RunFolder.resume(folder.path, {"noise": "absolute"})
    assert again.is_recorded
    second = identify_recorded(again, again.request.options)
    assert folder.recording.read_bytes() == kept
    assert second.signs == first.signs
    assert second.late_cycles == first.late_cycles
    found = second.result
    for name, share in _errors(second).items():
        assert share < max(0.02, 3.0 * found.standard_deviations[name] / found.parameters[name])


def test_an_interrupt_leaves_zero_torque_and_whole_plateaus_and_resume_does_the_rest(
    request_of_a_short_run: CalibrationRequest, tmp_path: Path
) -> None:
    folder = RunFolder.create(tmp_path / "run", request_of_a_short_run)
    adapter = SimulatedJointAdapter(default_joint(seed=3))
    with pytest.raises(KeyboardInterrupt), adapter:
        calibrate(SweepContext(adapter, 0, folder.request.settings), folder, folder.request.options, _interrupt_at(5))
    assert not adapter.enabled
    adapter.stand_in.step()
    assert adapter.stand_in.torque == [0.0]
    kept = load_sweep(folder.recording)
    assert [label.number for label, _ in kept.of_kind("plateau")] == [0, 1, 2, 3, 4]

    again = RunFolder.resume(tmp_path / "run")
    assert again.request == request_of_a_short_run
    with SimulatedJointAdapter(default_joint(seed=4)) as fresh:
        calibration = calibrate(SweepContext(fresh, 0, again.request.settings), again, again.request.options)
    numbers = [label.number for label, _ in calibration.data.of_kind("plateau")]
    assert numbers == list(range(14))
    before = kept.of_kind("plateau")[4][1]
    after = calibration.data.of_kind("plateau")[4][1]
    assert np.array_equal(before.torque, after.torque)
    assert np.all(np.diff(read_recording(folder.recording).time) > 0.0)


@pytest.mark.slow
def test_an_adaptive_sweep_that_is_gone_on_with_visits_the_first_speed_again(
    request_of_a_short_run: CalibrationRequest, tmp_path: Path
) -> None:
    options = replace(request_of_a_short_run.options, adaptive=True, accuracy=0.02)
    request = replace(request_of_a_short_run, options=options)
    folder = RunFolder.create(tmp_path / "run", request)
    for accuracy, report in ((1e-6, _interrupt_at(3, "adaptive")), (0.5, _interrupt_at(1, "first speed again"))):
        with pytest.raises(KeyboardInterrupt), SimulatedJointAdapter(default_joint(seed=3)) as adapter:
            calibrate(SweepContext(adapter, 0, request.settings), folder, replace(options, accuracy=accuracy), report)
        folder = RunFolder.resume(folder.path)
    with SimulatedJointAdapter(default_joint(seed=3)) as adapter:
        done = calibrate(SweepContext(adapter, 0, request.settings), folder, replace(options, accuracy=0.5))
    labels = [label for label, _ in done.data.of_kind("plateau")]
    assert len({label.number for label in labels}) == len(labels) == 12 + 3 + 2
    again = [label.velocity for label in labels if label.is_first_again]
    assert again == [label.velocity for label in labels[:2]]
    assert len(done.analysis.drift) == 2


def test_a_kill_in_the_middle_of_a_write_loses_only_that_block(context: SweepContext, folder: RunFolder) -> None:
    with pytest.raises(KeyboardInterrupt):
        calibrate(context, folder, folder.request.options, _interrupt_at(3))
    whole = folder.recording.read_bytes()
    folder.recording.write_bytes(whole[: len(whole) - 4000])
    assert [label.number for label, _ in load_sweep(folder.recording).of_kind("plateau")] == [0, 1]
    with folder.open_writer(context.metadata(), channels_of(context)) as writer:
        assert len(writer.blocks) == len(load_sweep(folder.recording).blocks)


def test_replacing_a_run_leaves_no_model_of_the_old_one(
    context: SweepContext, folder: RunFolder, request_of_a_short_run: CalibrationRequest
) -> None:
    calibration = calibrate(context, folder, folder.request.options)
    save_identification(calibration.estimate.result, folder.path)
    write_calibration_report(calibration, calibration_checks(calibration), {}, folder.path)
    (folder.path / "notes.txt").write_text("of the user")
    assert (folder.path / "friction.json").exists()
    RunFolder.create(folder.path, request_of_a_short_run, overwrite=True)
    assert {path.name for path in folder.path.iterdir()} == {LOCK_FILE, "run.json", "notes.txt"}


@pytest.mark.parametrize("overwrite", [False, True])
@pytest.mark.parametrize("name", ["recording.csv", "run.json", "friction.json"])
def test_files_of_somebody_else_are_neither_replaced_nor_removed(
    tmp_path: Path, request_of_a_short_run: CalibrationRequest, name: str, overwrite: bool
) -> None:
    (tmp_path / name).write_text("time,velocity\n0,0\n")
    with pytest.raises(
        OutputError, match=f"{name}, which a calibration writes too and which comes from something else"
    ):
        RunFolder.create(tmp_path, request_of_a_short_run, overwrite=overwrite)
    assert (tmp_path / name).read_text() == "time,velocity\n0,0\n"


def test_a_folder_with_a_run_is_not_overwritten(
    context: SweepContext, folder: RunFolder, request_of_a_short_run: CalibrationRequest
) -> None:
    with pytest.raises(KeyboardInterrupt):
        calibrate(context, folder, folder.request.options, _interrupt_at(1))
    with pytest.raises(SweepAborted, match="--resume"):
        RunFolder.create(folder.path, request_of_a_short_run)


def test_nothing_to_resume_is_said(tmp_path: Path) -> None:
    with pytest.raises(SweepAborted, match="nothing to resume"):
        RunFolder.resume(tmp_path)


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (JointLimits(5.0, 250.0, 0.5, (-2.9, 2.9)), "fit"),
        (JointLimits(5.0, 250.0, 8.0, (-0.02, 0.02)), "fit"),
        (JointLimits(0.5, 50.0, 8.0, (-2.9, 2.9)), "did not move"),
        (JointLimits(5.0, 250.0, 8.0, (-2.9, 2.9), temperature=20.0), "overtemperature"),
    ],
)
def test_limits_stop_the_run_safely(limits: JointLimits, words: str, folder: RunFolder) -> None:
    adapter = SimulatedJointAdapter(default_joint(), AdapterOptions((limits,)))
    with pytest.raises((SweepAborted, ParameterError, SafetyTrip), match=words), adapter:
        calibrate(SweepContext(adapter, 0, folder.request.settings), folder, folder.request.options)
    adapter.stand_in.step()
    assert adapter.stand_in.torque == [0.0]


@pytest.mark.slow
def test_the_loop_on_the_host_measures_the_same(adapter: SimulatedJointAdapter, folder: RunFolder) -> None:
    settings = replace(folder.request.settings, loop="host", inertia=0.1)
    calibration = calibrate(SweepContext(adapter, 0, settings), folder, folder.request.options)
    assert max(_errors(calibration).values()) < 0.03
    assert calibration.analysis.assistance is not None
    assert abs(calibration.analysis.assistance.value) < 0.01


@pytest.mark.slow
def test_too_little_damping_sticks_and_slips_on_the_falling_branch_and_is_rejected(
    adapter: SimulatedJointAdapter, folder: RunFolder
) -> None:
    """Damping 2 J w = 3 N·m·s/rad, where 0.86 (F_s - F_c)/v_s = 8.6 would be needed."""
    settings = replace(folder.request.settings, loop="host", inertia=0.1, bandwidth=15.0)
    with folder.open_writer(SweepContext(adapter, 0, settings).metadata(), CHANNELS) as writer:
        sweep = Sweep(SweepContext(adapter, 0, settings), writer, SweepData())
        sweep.prepare()
        sweep.run_plan(sweep.plan_first_pass())
    analysis = analyse_sweep(sweep.data)
    assert {abs(round(p.velocity, 2)) for p in analysis.rejected} & {0.01, 0.02, 0.03, 0.04, 0.05}
    assert all(abs(p.velocity) < 0.2 for p in analysis.rejected)
    assert "stick_slip" in {p.verdict for p in analysis.rejected}


CHANNELS = ("time", "position", "torque", "velocity", "velocity_reference")


@pytest.mark.slow
@pytest.mark.parametrize("joint", [0, 1])
def test_both_joints_of_the_arm_are_calibrated_under_gravity(joint: int, folder: RunFolder) -> None:
    with SimulatedJointAdapter(two_link_arm(disturbances=NO_DISTURBANCE, seed=1)) as adapter:
        body = RigidBody(packaged_model("two_link_arm"), ("shoulder", "elbow"))
        calibration = calibrate(
            SweepContext(adapter, joint, folder.request.settings, body), folder, folder.request.options
        )
    assert calibration.analysis.torque_source == "measured torque less the rigid-body torque"
    errors = _errors(calibration)
    viscous = {name for name in errors if name.endswith("viscous_coefficient")}
    assert max(errors[name] for name in errors if name not in viscous) < 0.03
    assert max(errors[name] for name in viscous) < 0.15


@pytest.mark.slow
def test_without_a_model_the_half_difference_gives_the_mean_of_both_directions(folder: RunFolder) -> None:
    settings = replace(folder.request.settings, dwell=0.8, inertia=0.1)
    options = replace(folder.request.options, gravity_unknown=True)
    with SimulatedJointAdapter(two_link_arm(disturbances=NO_DISTURBANCE, seed=1)) as adapter:
        calibration = calibrate(SweepContext(adapter, 1, settings), folder, options)
    found = calibration.estimate.result.model.forward
    assert found.coulomb_torque == pytest.approx(0.175, rel=0.04)
    assert found.static_torque == pytest.approx(0.65, rel=0.03)
    assert calibration.analysis.torque_source == "half difference of both directions"


@pytest.mark.slow
@pytest.mark.parametrize("speeds", ["0.01,0.03,0.05,0.08,0.3,1.5", "0.01,0.03,0.05,0.08,0.3,0.8,1.5,2.5,4"])
def test_without_a_model_the_age_of_the_torque_is_in_the_interval_of_the_viscous_coefficient(
    folder: RunFolder, speeds: str
) -> None:
    """3 ms along the gravity of the shoulder look like -0.007 N·m·s/rad."""
    settings = replace(folder.request.settings, speeds=speeds, dwell=0.8, breakaway_positions=5, inertia=0.1)
    options = replace(folder.request.options, gravity_unknown=True)
    with SimulatedJointAdapter(two_link_arm(seed=2)) as adapter:
        calibration = calibrate(SweepContext(adapter, 0, settings), folder, options)
    result = calibration.estimate.result
    interval = result.interval("symmetric_stribeck.curve.viscous_coefficient")
    assert interval.lower < 0.025 < interval.upper
    checks = {check.name: check for check in calibration_checks(calibration)}
    assert checks["Breakaway, mean of both directions"].outcome == "passed"
    assert checks["Compensation in the drive"].outcome == "passed"
    assert checks["Drift"].outcome == "passed"
    static = calibration.analysis.static_torque(1)
    assert static is not None
    assert static.value == pytest.approx(0.65, rel=0.05)
    drift = calibration.analysis.drift[0]
    assert drift.deviation < 0.01


def test_a_given_normal_load_leaves_the_parameters_as_they_are(context: SweepContext, folder: RunFolder) -> None:
    options = replace(folder.request.options, normal_load="12.5")
    calibration = calibrate(context, folder, options)
    assert max(_errors(calibration).values()) < 0.02
    law = calibration.estimate.result.model.law
    assert law.torque(0.5, normal_load=25.0) > 1.7 * float(law.torque(0.5, normal_load=12.5))


def test_the_normal_load_is_what_the_run_says(context: SweepContext, folder: RunFolder) -> None:
    with pytest.raises(KeyboardInterrupt):
        calibrate(context, folder, folder.request.options, _interrupt_at(3))
    data = load_sweep(folder.recording)
    given = analyse_sweep(data, normal_load="12.5")
    assert given.load_source == "given as 12.5"
    assert {p.normal_load for p in given.points} == {12.5}
    assert analyse_sweep(data, normal_load="transmitted").load_source == "the model's transmitted torque"
    with pytest.raises(ParameterError, match="no normal_load column"):
        analyse_sweep(data, normal_load="column")
    with pytest.raises(ParameterError, match="none of none"):
        analyse_sweep(data, normal_load="heavy")


@pytest.mark.slow
def test_an_adaptive_sweep_stops_when_it_is_accurate_enough(adapter: SimulatedJointAdapter, folder: RunFolder) -> None:
    settings = replace(folder.request.settings, speeds="", speed_count=6)
    options = replace(folder.request.options, adaptive=True, accuracy=0.003)
    calibration = calibrate(SweepContext(adapter, 0, settings), folder, options)
    result = calibration.estimate.result
    deviations = [result.standard_deviations[n] / result.parameters[n] for n in result.parameter_names]
    assert np.mean(deviations) < 0.004
    assert max(_errors(calibration).values()) < 0.02


@pytest.mark.slow
def test_a_drive_that_compensates_friction_is_noticed(folder: RunFolder) -> None:
    """The joint is left with a fiftieth of its dry friction in motion, as behind a drive that adds the rest."""
    law = DEFAULT_LAW.replace(
        {"stribeck.forward.coulomb_torque": 0.003, "stribeck.reverse.coulomb_torque": 0.003,
         "stribeck.forward.viscous_coefficient": 0.0, "stribeck.reverse.viscous_coefficient": 0.0}
    )  # fmt: skip
    settings = replace(folder.request.settings, speeds="0.15,0.2,0.3,0.5,0.8,1.5")
    with SimulatedJointAdapter(default_joint(law=law)) as adapter:
        context = SweepContext(adapter, 0, settings)
        with folder.open_writer(context.metadata(), channels_of(context)) as writer:
            sweep = Sweep(context, writer, SweepData())
            sweep.prepare()
            sweep.run_plan(sweep.plan_first_pass())
            sweep.measure_breakaways(0.01)
    check = compensation_check(analyse_sweep(sweep.data))
    assert check is not None
    assert check.outcome == "warning"
    assert "compensate" in check.detail


def test_a_motion_from_a_file_is_recorded_the_same_way(
    context: SweepContext, folder: RunFolder, tmp_path: Path
) -> None:
    time = np.arange(0.0, 2.0, 0.01)
    velocity = 0.8 * np.sin(np.pi * time)
    table = tmp_path / "motion.csv"
    np.savetxt(table, np.column_stack([time, velocity]), delimiter=",", header="time,velocity", comments="")
    with folder.open_writer(context.metadata(), channels_of(context)) as writer:
        sweep = Sweep(context, writer, SweepData())
        sweep.prepare()
        record_motion(sweep, read_motion(table))
        sweep.finish()
    (_, samples), *_ = load_sweep(folder.recording).of_kind("motion")
    assert samples.velocity is not None
    assert samples.velocity_reference is not None
    assert np.sqrt(np.mean((samples.velocity - samples.velocity_reference) ** 2)) < 0.1


def test_a_motion_that_is_stopped_is_kept_once_the_joint_is_at_zero_torque(
    context: SweepContext, folder: RunFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted(MotionFile):
        def velocity_at(self, time: float) -> float | None:
            if time > 0.3:
                raise KeyboardInterrupt
            return super().velocity_at(time)

    energised, write = [], Sweep.write

    def noting(sweep: Sweep, log: CycleLog, label: BlockLabel) -> Recording:
        energised.append((label.kind, context.adapter.enabled))
        return write(sweep, log, label)

    motion = Interrupted(np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.4, 0.0]))
    with folder.open_writer(context.metadata(), channels_of(context)) as writer:
        sweep = Sweep(context, writer, SweepData())
        sweep.prepare()
        monkeypatch.setattr(Sweep, "write", noting)
        with pytest.raises(KeyboardInterrupt):
            record_motion(sweep, motion)
    assert energised == [("motion", False)]
    ((label, samples),) = load_sweep(folder.recording).of_kind("motion")
    assert label.is_cut
    assert samples.duration == pytest.approx(0.3, abs=0.01)


@pytest.mark.parametrize("text", ["time,speed\n0,1\n1,1\n", "time,velocity\n0,0\n0,1\n", "time,velocity\n0,0\n"])
def test_a_motion_file_that_makes_no_sense_is_refused(text: str, tmp_path: Path) -> None:
    file = tmp_path / "motion.csv"
    file.write_text(text)
    with pytest.raises(ParameterError):
        read_motion(file)


def test_a_motion_that_does_not_fit_is_refused_before_it_starts(
    context: SweepContext, folder: RunFolder, tmp_path: Path
) -> None:
    file = tmp_path / "motion.csv"
    file.write_text("time,velocity\n0,0\n5,3\n10,3\n")
    with folder.open_writer(context.metadata(), channels_of(context)) as writer:
        sweep = Sweep(context, writer, SweepData())
        sweep.prepare()
        with pytest.raises(ParameterError, match="travel"):
            record_motion(sweep, read_motion(file))


@pytest.mark.slow
def test_a_joint_without_slow_speeds_takes_its_static_torque_from_breakaway(
    adapter: SimulatedJointAdapter, folder: RunFolder
) -> None:
    settings = replace(folder.request.settings, speeds="0.04,0.05,0.07,0.1,0.3,1.5", breakaway_positions=2)
    calibration = calibrate(SweepContext(adapter, 0, settings), folder, folder.request.options)
    assert [p.number for p in calibration.estimate.used].count(-1) == 2
    assert _errors(calibration)["stribeck.forward.static_torque"] < 0.02


def test_gravity_and_inertia_of_the_default_joint() -> None:
    body = RigidBody(packaged_model("default_joint"), ("joint",))
    assert not body.has_gravity_on(0)
    assert body.inertias([0.3]) == pytest.approx([0.1], rel=1e-6)
    with pytest.raises(ParameterError, match="it has joint"):
        RigidBody(packaged_model("default_joint"), ("elbow",))


def test_gravity_of_the_arm_is_that_of_its_masses() -> None:
    body = RigidBody(packaged_model("two_link_arm"), ("shoulder", "elbow"))
    angle = np.array([[0.7, 0.0]])
    still = np.zeros((1, 2))
    level = 9.81 * np.sin(0.7) * (1.0 * 0.15 + 0.6 * (0.3 + 0.125))
    assert body.torque(0, angle, still, still) == pytest.approx([level], rel=1e-6)
