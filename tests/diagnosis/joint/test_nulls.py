"""Nulls of a joint whose loop sees a coarse encoder: its answer to the steps is torque that moved the joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis.inputs.controller import Controller
from fricomp.diagnosis.inputs.delay import shift
from fricomp.diagnosis.inputs.track import FloatArray, PositionNoise, TorqueNoise, differentiate
from fricomp.diagnosis.joint import nulls as nulls_module
from fricomp.diagnosis.joint import problem as problem_module
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.nulls import _compute_variation, _find_sliding, make_nulls
from fricomp.diagnosis.joint.observer import Contribution, Job, Observation, Observer
from fricomp.diagnosis.joint.problem import Problem, Weights, build_problem
from fricomp.diagnosis.joint.settings import JOINT as SETTINGS
from fricomp.diagnosis.joint.step_answer import StepAnswer, simulate_step_answers
from fricomp.diagnosis.search.preparation import prepare

from ..toy_joint import ToyJoint, recording
from .test_observer import true_plant

JOINT = ToyJoint(resolution=2.0 * np.pi / 2**16, torque_noise=0.02, gains=(2500.0, 40.0))
# The toy's loop: it filters its velocity with 0.3 a sample, which is 57 Hz.
LOOP = Controller(*JOINT.gains, velocity_filter_frequency=-np.log(0.7) * 1e3 / (2.0 * np.pi))


def problem_of(loop: Controller | None = LOOP, noise: float = 0.02, resolution: float = JOINT.resolution) -> Problem:
    """The problem of a recording of the toy."""
    track = build_tracks([recording(JOINT, "fourier", 15.0)], [loop])[0]
    track = replace(track, torque_noise=TorqueNoise(noise, 0.0, 0.0), resolution=resolution)
    return build_problem([track], true_plant(JOINT), Observer())


def answer_in(problem: Problem) -> tuple[Observation, FloatArray, list[StepAnswer]]:
    """A motion without steps, the torque that it takes, and how the loop answers to steps in it."""
    plant, track = true_plant(JOINT), problem.tracks[0]
    window = np.hanning(13)
    smooth = np.convolve(np.pad(track.torque, 6, mode="edge"), window / window.sum(), mode="valid")
    truth = problem.observe([Job(replace(track, torque=smooth), plant, Contribution())])[0]
    torque = smooth + shift(truth.missing, -plant.delay / track.dt)
    return truth, torque, simulate_step_answers(Job(track, plant, Contribution()), truth, torque, count=2, seed=0)


def row_size(problem: Problem, position: FloatArray, torque: FloatArray) -> float:
    """Typical size of the rows where the joint is at `position` under `torque` [N·m]."""
    track = problem.tracks[0]
    moved = replace(track, position=position, torque=torque, velocity=differentiate(position, track.dt))
    run = problem.observe([Job(moved, true_plant(JOINT), Contribution())])[0]
    return float(np.median(np.abs(np.diff(problem.grids[0].average(run.missing), 2))))


def test_memory_bounds_how_many_are_simulated_at_once_and_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    plant, nothing = true_plant(JOINT), [Contribution()]
    plants = [replace(plant, offset=offset) for offset in np.linspace(-0.1, 0.1, 40)]
    track = build_tracks([recording(JOINT, "fourier", 6.0)])[0]
    problem = build_problem([track], plant, Observer())

    def simulate() -> tuple[FloatArray, FloatArray]:
        nulls = make_nulls(problem, plant, nothing, count=20, seed=3)
        return np.stack(problem.compute_vectors(plants, (nothing for _ in plants))), nulls.rows[0]

    whole = simulate()
    monkeypatch.setattr(problem_module, "JOINT", replace(SETTINGS, most_held=1))
    monkeypatch.setattr(nulls_module, "JOINT", replace(SETTINGS, most_held=1))
    held: list[int] = []
    run = problem_module.Problem.compute_missing

    def count(self: Problem, jobs: Sequence[Job]) -> list[FloatArray]:
        held.append(len(jobs))
        return run(self, jobs)

    monkeypatch.setattr(Problem, "compute_missing", count)
    for a, b in zip(whole, simulate(), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)
    assert max(held) <= 16


@pytest.mark.slow
def test_the_torque_of_an_answer_moves_the_joint() -> None:
    problem = problem_of()
    truth, torque, (answer, other) = answer_in(problem)
    assert np.any(answer.torque != other.torque)  # another origin of the encoder
    told = row_size(problem, answer.position, torque + answer.torque)
    recorded = problem.tracks[0]
    assert told == pytest.approx(row_size(problem, recorded.position, recorded.torque), rel=0.2)
    unmoved = np.round(truth.position / JOINT.resolution) * JOINT.resolution
    assert told < 0.8 * row_size(problem, unmoved, torque + answer.torque)


@pytest.mark.parametrize(
    "how",
    [
        {"loop": None},
        {"loop": replace(LOOP, derivative_gain=0.0)},
        {"loop": replace(LOOP, proportional_gain=-4e4)},  # which moved no joint along this motion
        {"noise": 5.0},
        {"resolution": 0.0},
    ],
    ids=["no loop", "no damping", "unstable", "lost in noise", "no steps"],
)
def test_no_answer_is_heard_without_a_loop_or_steps(how: dict[str, Any]) -> None:
    assert answer_in(problem_of(**how))[2] == []


@pytest.mark.slow
def test_what_moved_the_joint_is_no_noise_of_its_nulls() -> None:
    one = recording(replace(JOINT, torque_noise=0.01), "fourier", 30.0)  # so that the steps show above the noise
    with_loop, without = (
        prepare(build_tracks([one], [loop]), observer=Observer(), nulls=16, seed=0) for loop in (LOOP, None)
    )
    assert with_loop.noise_ratio == pytest.approx(1.0, abs=0.1)
    assert np.median(with_loop.nulls.weights.spread[0]) < 0.95 * np.median(without.nulls.weights.spread[0])


def test_noise_is_matched_where_the_joint_slides() -> None:
    problem = problem_of()
    still = replace(problem.tracks[0], velocity=np.where(np.arange(problem.tracks[0].size) < 7000, 0.0, 1.0))
    slides = _find_sliding(replace(problem, tracks=(still,)), 0)
    rows = np.random.default_rng(0).normal(size=(4, slides.size)) * np.where(slides, 1.0, 1e-3)
    assert 0.4 < np.mean(slides) < 0.6
    whole = _compute_variation(rows, slides)
    assert whole == pytest.approx(
        _compute_variation(rows[:, slides], np.ones(np.count_nonzero(slides), dtype=bool)), rel=0.1
    )
    assert np.all(_compute_variation(rows, np.ones_like(slides)) < 0.5 * whole)


def test_where_the_joint_hardly_slides_all_rows_count() -> None:
    problem = problem_of()
    resting = replace(problem.tracks[0], velocity=np.zeros(problem.tracks[0].size))
    assert np.all(_find_sliding(replace(problem, tracks=(resting,)), 0))


@pytest.mark.parametrize(("noise", "off"), [(2e-5, 0.05), (1e-4, 0.25)])
def test_noise_of_a_position_is_none_of_the_torque(noise: float, off: float) -> None:
    """A bristle at rest takes up that of a torque, and nulls with it alone would be quieter there than the joint.

    Of the larger noise single recordings stray by 0.07 to 0.44, so that the middle one of three is looked at.
    """
    smooth = recording(ToyJoint(resolution=1e-9, torque_noise=1e-4), "fourier", 15.0, every=2)
    ratios = []
    for seed in (1, 2, 3):
        drawn = np.random.default_rng(seed).standard_normal(len(smooth))
        (track,) = build_tracks([replace(smooth, position=np.array(smooth.position) + noise * drawn)])
        assert track.position_noise.measure_own(track.resolution) == pytest.approx(noise, rel=0.05)
        ratios.append(prepare([track], observer=Observer(), nulls=8, seed=0).noise_ratio)
    assert np.median(ratios) == pytest.approx(1.0, abs=off)


def test_a_position_has_noise_of_its_own_where_it_is_more_than_rounding() -> None:
    assert PositionNoise(3e-4, 0.0).measure_own(5e-4) == pytest.approx(np.sqrt(9.0 - 25.0 / 12.0) * 1e-4, rel=0.07)
    assert PositionNoise(2.5e-4, 0.0).measure_own(5e-4) == 0.0
    assert PositionNoise(1.87e-5, 0.0).measure_own(0.0) == pytest.approx(2e-5)


def test_columns_are_whitened_as_rows_are() -> None:
    rows = np.random.default_rng(2).standard_normal((50, 3))
    weights = Weights((np.zeros(50),), (np.ones(50),), np.array([1.1, -0.4, 0.2, 0.1]))
    known = np.stack([weights.apply([rows[:, 0]]), weights.apply([rows[:, 1]])], axis=1)
    found = weights.whiten(rows[:, :2] + 1j * rows[:, 2:])
    np.testing.assert_allclose(found.real, known, atol=1e-12)
    np.testing.assert_allclose(found.imag[:, 0], weights.apply([rows[:, 2]]), atol=1e-12)
