"""Settling, stick-slip, breakaway, signs and lag, on signals whose truth is known."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.stats import t as student

from fricomp.calibration.identification import Status
from fricomp.calibration.sweep.analysis.analysis import HALF_DIFFERENCE, SweepAnalysis, TorqueSource, measure_offset
from fricomp.calibration.sweep.analysis.block import BlockLabel, SweepData
from fricomp.calibration.sweep.analysis.breakaway import Breakaway, half_differences_at_rest, measure_breakaway
from fricomp.calibration.sweep.analysis.gravity_fit import LAG_PRIOR, fit_gravity
from fricomp.calibration.sweep.analysis.point import FrictionPoint, SettledPart, half_differences
from fricomp.calibration.sweep.analysis.rigid_body_fit import RigidBodyFit, fit_rigid_body
from fricomp.calibration.sweep.analysis.steadiness import Mean, Verdict, find_transient, judge_plateau, mean_of
from fricomp.calibration.sweep.calibrate import Calibration
from fricomp.calibration.sweep.estimate import IdentificationSettings, estimate_friction
from fricomp.calibration.sweep.motion.sign_check import check_signs
from fricomp.calibration.sweep.planning.settling import SettleDetector, longest_settling
from fricomp.calibration.sweep.report.check import calibration_checks
from fricomp.errors import IdentificationError, SweepAborted
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

QUANTUM = 2.4e-5
RATE = 500.0


def _encode(position: FloatArray) -> FloatArray:
    return np.round(position / QUANTUM) * QUANTUM


def _judge(position: ArrayLike, velocity: float, torque: float = 0.3) -> str:
    encoded = _encode(np.asarray(position, dtype=np.float64))
    time = np.arange(len(encoded)) / RATE
    return judge_plateau(
        np.asarray(time, dtype=np.float64),
        encoded,
        np.full(len(time), torque),
        velocity,
        quantum=QUANTUM,
        torque_limit=5.0,
    )


@pytest.mark.parametrize("velocity", [0.002, 0.01, 0.1, -1.0])
def test_steady_sliding_is_steady_however_slow(velocity: float) -> None:
    assert _judge(velocity * np.arange(600) / RATE, velocity) == "steady"


@pytest.mark.parametrize("velocity", [0.02, -0.05])
def test_sticking_and_slipping_is_told_from_sliding(velocity: float) -> None:
    time = np.arange(1000) / RATE
    phase = np.mod(time, 0.2) / 0.2
    position = velocity * 0.2 * (np.floor(time / 0.2) + np.clip((phase - 0.7) / 0.3, 0.0, 1.0))
    assert _judge(position, velocity) == "stick_slip"


def test_a_plateau_at_another_speed_has_not_settled() -> None:
    assert _judge(0.09 * np.arange(600) / RATE, 0.1) == "unsettled"


def test_a_drive_at_its_torque_limit_is_saturated() -> None:
    assert _judge(0.1 * np.arange(600) / RATE, 0.1, torque=5.0) == "saturated"


def test_a_plateau_of_few_samples_is_short() -> None:
    assert _judge(0.1 * np.arange(20) / RATE, 0.1) == "short"


def test_the_error_of_a_mean_covers_correlated_noise() -> None:
    generator = np.random.default_rng(0)
    means = []
    for _ in range(300):
        white = generator.normal(size=1200)
        noise = np.convolve(white, np.ones(10) / np.sqrt(10.0), "valid")
        mean = mean_of(noise)
        means.append(mean.value / mean.deviation)
    assert 0.85 < np.std(means) < 1.25


def test_settling_waits_for_the_speed() -> None:
    detector, settled_at = SettleDetector(0.1, QUANTUM, 1.0 / RATE), None
    time, position = 0.0, 0.0
    while settled_at is None and time < 3.0:
        time += 1.0 / RATE
        position += 0.1 * (1.0 - np.exp(-time / 0.1)) / RATE
        if detector.update(time, float(_encode(np.array(position)))):
            settled_at = time
    assert settled_at is not None
    assert 0.25 < settled_at < 0.6


def test_a_joint_that_sticks_never_settles() -> None:
    detector = SettleDetector(0.1, QUANTUM, 1.0 / RATE)
    assert not any(detector.update(k / RATE, 0.0) for k in range(1000))


def test_settling_is_seen_through_a_coarse_encoder() -> None:
    """Windows end where the encoder counts; ended anywhere they would be off by a count in eight, and never agree."""
    coarse, velocity = 25.0 / 65535.0, 0.02
    detector = SettleDetector(velocity, coarse, 1.0 / RATE)
    settled = [detector.update(k / RATE, round(velocity * k / RATE / coarse) * coarse) for k in range(1, 2000)]
    assert any(settled)
    assert settled.index(True) / RATE < longest_settling(velocity, coarse)


def test_samples_that_come_late_do_not_keep_a_plateau_from_settling() -> None:
    detector, generator = SettleDetector(0.1, QUANTUM, 1.0 / RATE), np.random.default_rng(5)
    late = np.where(generator.random(800) < 0.02, 0.03, 0.0)
    times = np.maximum.accumulate(np.arange(1, 801) / RATE + late)
    assert any(detector.update(float(t), 0.1 * k / RATE) for k, t in enumerate(times, start=1))


def test_samples_that_come_late_are_no_stick_slip() -> None:
    generator = np.random.default_rng(6)
    truth = np.arange(1000) / RATE
    time = np.maximum.accumulate(truth + np.where(generator.random(1000) < 0.01, 0.05, 0.0)) + 1e-6 * truth
    verdict = judge_plateau(time, _encode(0.1 * truth), np.full(1000, 0.3), 0.1, quantum=QUANTUM, torque_limit=5.0)
    assert verdict == "steady"


def test_a_transient_is_found_and_plain_noise_is_left_alone() -> None:
    generator = np.random.default_rng(7)
    noise = 0.005 * generator.normal(size=(200, 800))
    tail = 0.05 * np.exp(-np.arange(800) / 60.0)
    found = [find_transient(np.asarray(row + tail)) for row in noise]
    assert min(found) >= 50
    cut = [find_transient(np.asarray(row)) for row in noise]
    assert np.mean([n > 0 for n in cut]) < 0.3


def _ramp(level: float, direction: int, *, slips: bool) -> Recording:
    """Torque rises by 1 N·m/s until the joint creeps on at `level`, or slips away."""
    generator = np.random.default_rng(1)
    time = np.arange(0.0, level + 0.4, 1.0 / RATE)
    loose = np.maximum(time - level, 0.0)
    torque = np.minimum(time, level)
    position = (5.0 * loose**2) if slips else 0.001 * loose
    noise = 0.002 * generator.normal(size=len(time))
    return Recording(time, _encode(direction * position), direction * torque + noise)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("slips", [True, False])
def test_breakaway_is_where_the_ramp_ends(direction: int, slips: bool) -> None:
    found = measure_breakaway(_ramp(0.6, direction, slips=slips), direction, offset=0.0, quantum=QUANTUM)
    assert found is not None
    assert found.torque == pytest.approx(0.6, rel=0.02)


def test_a_joint_held_fast_has_no_breakaway() -> None:
    time = np.arange(0.0, 2.0, 1.0 / RATE)
    still = Recording(time, np.zeros_like(time), time)
    assert measure_breakaway(still, 1, offset=0.0, quantum=QUANTUM) is None


def _push(sign: float = 1.0, velocity_scale: float = 1.0, torque_scale: float = 1.0) -> Recording:
    time = np.arange(0.0, 1.0, 1.0 / RATE)
    command = 0.5 * time
    position = sign * 0.05 * np.maximum(time - 0.5, 0.0) ** 2
    velocity = velocity_scale * np.gradient(position, time)
    return Recording(time, position, torque_scale * command + 0.01, velocity=velocity, torque_command=command)


def test_right_signs_and_scales_pass() -> None:
    check = check_signs(_push(), torque_is_echo=False)
    assert check.velocity_ratio == pytest.approx(1.0, abs=0.02)
    assert check.torque_ratio == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("push", "words"),
    [
        (_push(sign=-1.0), "opposite directions"),
        (_push(velocity_scale=57.3), r"57.3 times the distance.*57.3 is degrees"),
        (_push(velocity_scale=-1.0), "its sign"),
        (_push(torque_scale=1e-3), "torque constant"),
        (_push(torque_scale=-1.0), "sign"),
    ],
)
def test_a_wrong_sign_or_scale_stops_the_run(push: Recording, words: str) -> None:
    with pytest.raises(SweepAborted, match=words):
        check_signs(push, torque_is_echo=False)


def test_the_half_difference_takes_gravity_off() -> None:
    points = [
        FrictionPoint(0, 1.0, 0.1, 0.3 + 2.0, 0.01, 1.0, "steady"),
        FrictionPoint(1, 2.0, -0.1, -0.3 + 2.0, 0.01, 1.0, "steady"),
        FrictionPoint(2, 3.0, 0.2, 0.4 + 2.0, 0.01, 1.0, "steady"),
        FrictionPoint(3, 4.0, -0.2, -0.4 + 2.0, 0.01, 1.0, "stick_slip"),
    ]
    found = half_differences(points)
    assert [p.torque for p in found] == pytest.approx([0.3, -0.3, 0.4, -0.4])
    assert [p.verdict for p in found] == ["steady", "steady", "stick_slip", "stick_slip"]


@pytest.mark.parametrize(("lag", "scale"), [(0.003, 1.0), (0.0, 1.1), (0.005, 0.95)])
def test_lag_and_scale_of_the_torque_are_recovered_from_fast_motions(lag: float, scale: float) -> None:
    generator = np.random.default_rng(2)
    blocks = []
    for velocity in (2.0, -2.0, 4.0, -4.0):
        time = np.arange(0.0, 0.8, 1.0 / RATE)
        position = velocity * (time - 0.4)
        load = 4.0 * np.sin(position)
        torque = scale * 4.0 * np.sin(velocity * (time - lag - 0.4)) + 0.2 * np.sign(velocity)
        torque = torque + 0.003 * generator.normal(size=len(time))
        reference = np.full(len(time), velocity)
        blocks.append(Recording(time, position, torque, load_torque=load, velocity_reference=reference))
    fit = fit_rigid_body(blocks)
    assert fit.lag == pytest.approx(lag, abs=3e-4)
    assert fit.scale == pytest.approx(scale, abs=0.01)


def _counted(verdicts: list[Verdict]) -> SweepAnalysis:
    points = tuple(FrictionPoint(n, float(n), 0.1, 0.3, 0.01, 1.0, verdict) for n, verdict in enumerate(verdicts))
    return SweepAnalysis(
        points, (), Mean(0.0, 0.0), RigidBodyFit(), "measured torque", "", (), None, RecordingMetadata()
    )


@pytest.mark.parametrize(
    ("verdicts", "there", "absent"),
    [
        (["steady"] * 8, "none was rejected, the sweep was too short", "sticking"),
        (["steady"] * 8 + ["unsettled"] * 4, "4 not settled", "sticking"),
        (["stick_slip"] * 9 + ["short"], "9 sticking and slipping, 1 too short", "was rejected, the sweep"),
    ],
)
def test_too_few_plateaus_are_told_with_the_true_reason(verdicts: list[Verdict], there: str, absent: str) -> None:
    with pytest.raises(IdentificationError, match="at least 10") as caught:
        estimate_friction(_counted(verdicts), IdentificationSettings())
    assert there in str(caught.value)
    assert absent not in str(caught.value)


def _parts(lag: float, slope: float, speeds: tuple[float, ...]) -> list[SettledPart]:
    """Plateaus of an arm whose torque is old, whose friction grows with its load, and that nobody has a model of."""
    generator, parts = np.random.default_rng(11), []
    for number, speed in enumerate(s for v in speeds for s in (v, -v)):
        time = np.arange(0.0, 0.6, 1.0 / RATE)
        position = speed * (time - 0.3)
        gravity = slope * np.sin(position - speed * lag + 0.3)
        friction = 0.2 + 0.02 * abs(speed) + 0.03 * np.abs(gravity)
        torque = gravity + np.sign(speed) * friction + 0.01 * generator.normal(size=len(time))
        parts.append(SettledPart(number, speed, Recording(time, _encode(position), torque)))
    return parts


@pytest.mark.parametrize("lag", [0.0, 0.003, 0.006])
def test_the_age_of_the_torque_shows_in_the_mean_of_both_directions(lag: float) -> None:
    fit = fit_gravity(_parts(lag, 4.0, (0.5, 1.0, 2.0, 3.0, 4.0, 4.0)))
    assert fit is not None
    assert fit.is_measured
    assert fit.lag == pytest.approx(lag, abs=3.0 * fit.lag_deviation)
    assert fit.lag_deviation < 1.2e-3
    place = np.linspace(-1.0, 1.0, 50)
    error = fit.torque(place) - 4.0 * np.sin(place + 0.3)
    assert np.ptp(error) < 0.2  # of 6.7


@pytest.mark.parametrize(("slope", "speeds"), [(0.0, (0.5, 1.0, 2.0, 4.0)), (4.0, (0.05, 0.1, 0.2))])
def test_an_age_that_does_not_show_is_left_open(slope: float, speeds: tuple[float, ...]) -> None:
    fit = fit_gravity(_parts(0.003, slope, speeds))
    assert fit is not None
    assert not fit.is_measured
    assert (fit.lag, fit.lag_deviation) == LAG_PRIOR


def test_the_half_difference_takes_gravity_off_breakaways_at_the_same_place() -> None:
    found = [
        Breakaway(0.1, -1, 0.65 - 2.0, 1.0, 0),
        Breakaway(0.1, 1, 0.65 + 2.0, 2.0, 1),
        Breakaway(0.5, -1, 0.7 - 1.0, 3.0, 2),
        Breakaway(0.9, 1, 0.6 + 3.0, 4.0, 5),
    ]
    assert [b.torque for b in half_differences_at_rest(found)] == pytest.approx([0.65, 0.65])


def test_the_intervals_of_half_differences_count_each_pair_once() -> None:
    """Nine pairs, scattering by 2 mN·m: the truth is where the intervals say."""
    generator, speeds, errors = np.random.default_rng(5), np.geomspace(0.01, 3.0, 9), []
    for _ in range(60):
        points = []
        for number, speed in enumerate(speeds):
            friction = 0.175 + 0.475 * np.exp(-((speed / 0.05) ** 2)) + 0.025 * speed + 0.002 * generator.normal()
            for side in (1, -1):
                index = 2 * number + (side < 0)
                points.append(FrictionPoint(index, 0.0, side * speed, side * friction, 0.002, 1.0, "steady"))
        analysis = replace(_counted([]), points=tuple(points), torque_source=HALF_DIFFERENCE)
        result = estimate_friction(analysis, IdentificationSettings(method="least_squares", noise="absolute")).result
        name = "symmetric_stribeck.curve.viscous_coefficient"
        errors.append((result.parameters[name] - 0.025) / result.standard_deviations[name])
    assert 0.8 < np.median(np.abs(errors)) / 0.6745 < 1.4
    assert result.model.covariance is not None
    assert result.freedom == result.model.covariance.degrees_of_freedom == 9 - 4  # pairs less parameters
    interval, deviation = result.interval(name), result.standard_deviations[name]
    assert interval.upper - interval.lower == pytest.approx(2.0 * student.ppf(0.975, 5) * deviation)


@pytest.mark.parametrize(("deviation", "status"), [(0.001, Status.CONVERGED), (0.3, Status.NOT_IDENTIFIABLE)])
def test_a_zero_of_the_torque_that_nobody_knows_leaves_friction_undetermined(deviation: float, status: Status) -> None:
    points = []
    for number, speed in enumerate(np.geomspace(0.01, 3.0, 9)):
        friction = 0.15 + 0.45 * np.exp(-((speed / 0.05) ** 2)) + 0.02 * speed
        for side in (1, -1):
            index = 2 * number + (side < 0)
            points.append(FrictionPoint(index, 0.0, side * speed, side * friction, 0.002, 1.0, "steady"))
    analysis = _counted([])
    offset = replace(analysis.offset, deviation=deviation)
    analysis = replace(analysis, points=tuple(points), offset=offset)
    result = estimate_friction(analysis, IdentificationSettings(method="least_squares", noise="absolute")).result
    assert result.status is status
    assert result.model.provenance.status == str(status)


@pytest.mark.parametrize(
    ("source", "status", "outcome"),
    [("measured torque", Status.LACK_OF_FIT, "warning"), (HALF_DIFFERENCE, Status.CONVERGED, "passed")],
)
def test_a_sweep_that_departs_from_the_law_is_a_warning_where_its_points_are_independent(
    source: TorqueSource, status: Status, outcome: str
) -> None:
    generator, points = np.random.default_rng(0), []
    for number, speed in enumerate(np.geomspace(0.01, 3.0, 40)):
        friction = 0.15 + 0.45 * np.exp(-speed / 0.05) + 0.02 * speed + 0.005 * generator.normal()
        for side in (1, -1):
            torque = side * (friction if source == HALF_DIFFERENCE else friction + 0.005 * generator.normal())
            points.append(FrictionPoint(2 * number + (side < 0), 0.0, side * speed, torque, 0.005, 1.0, "steady"))
    analysis = replace(_counted([]), points=tuple(points), torque_source=source)
    estimate = estimate_friction(analysis, IdentificationSettings(method="least_squares", noise="absolute"))
    assert estimate.result.status is status
    checked = calibration_checks(Calibration(SweepData(()), analysis, estimate, 0, None))
    assert next(check for check in checked if check.name == "Identification").outcome == outcome


def test_without_a_model_there_is_no_lag() -> None:
    time = np.arange(0.0, 1.0, 1.0 / RATE)
    assert fit_rigid_body([Recording(time, time, time)]).lag == 0.0


def _rests(readings: FloatArray, step: float) -> SweepData:
    metadata = RecordingMetadata(extra={"torque_quantum": step})
    time = np.arange(len(readings)) / RATE
    samples = Recording(time, np.zeros_like(time), readings, metadata=metadata)
    return SweepData(((BlockLabel("tare"), samples), (BlockLabel("tare"), samples)))


def test_a_zero_that_falls_between_two_codes_is_no_offset() -> None:
    """An MIT motor has no code for no torque and reads half a step at rest."""
    step = 20.0 / 4095.0
    zero = measure_offset(_rests(np.full(1000, 0.5 * step), step))
    assert zero.value == pytest.approx(0.0, abs=1e-12)
    assert zero.deviation == pytest.approx(step / np.sqrt(12.0))


@pytest.mark.parametrize("offset", [0.0, 0.0011, -0.004])
def test_noise_dithers_the_rounding_of_the_zero(offset: float) -> None:
    step, generator = 20.0 / 4095.0, np.random.default_rng(3)
    readings = (np.floor((offset + 0.6 * step * generator.normal(size=5000)) / step) + 0.5) * step
    zero = measure_offset(_rests(readings, step))
    assert zero.value == pytest.approx(offset, abs=3.0 * zero.deviation + 1e-5)
    assert zero.deviation < 0.05 * step
