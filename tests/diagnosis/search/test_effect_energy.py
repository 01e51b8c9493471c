"""Where effects show: what a refit of a plain joint takes up is no trace of them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import Structure
from fricomp.diagnosis.inputs.track import FloatArray, Track
from fricomp.diagnosis.joint.observer import Contribution, Observation, Observer, Plant
from fricomp.diagnosis.joint.problem import Problem, build_problem
from fricomp.diagnosis.search.effect_energy import compute_effect_energy
from fricomp.diagnosis.search.preparation import Baseline

_DT, _INERTIA = 1e-3, 0.3
_PLANT = Plant(_INERTIA, (1.0, 6.0), 0.0, (2.0, 2.6, 0.05, 1.0), (2.2, 2.8, 0.06, 1.1), 4e4)
_TIME = np.arange(12_000) * _DT
_POSITION = 0.7 * np.sin(1.3 * _TIME) + 0.3 * np.sin(3.1 * _TIME)
_VELOCITY = np.gradient(_POSITION, _DT)
_SENSE = np.tanh(_VELOCITY / 1e-2)  # a bristle turns within some samples


def _energy(
    torque: FloatArray, *, resolution: float = 0.0, position: FloatArray = _POSITION, spread: FloatArray | float = 0.1
) -> FloatArray:
    """Energy, sample by sample, of effects that add `torque` to a joint with this motion."""
    track = replace(Track.build(_DT, position, np.zeros_like(_TIME)), resolution=resolution)
    problem = build_problem([track], _PLANT, Observer())
    forth, back = (c + (s - c) * np.exp(-((_VELOCITY / v) ** 2)) for c, s, v, _ in (_PLANT.forward, _PLANT.reverse))
    complete = Observation(np.zeros_like(torque), _POSITION, _VELOCITY, _SENSE * np.where(_SENSE > 0.0, forth, back))
    runs = [complete], [complete._replace(missing=torque)]
    structure = SimpleNamespace(unpack_plant=lambda theta: _PLANT, observe_with_and_without=lambda *_: runs)
    spreads = [np.broadcast_to(spread, problem.grids[0].centres.shape)]
    weights = SimpleNamespace(weights=SimpleNamespace(spread=spreads))
    baseline = cast(Baseline, SimpleNamespace(problem=problem, nulls=weights))
    (energy,) = compute_effect_energy(baseline, cast(Structure, structure), np.zeros(0), {"end_stop"})
    assert energy.shape == torque.shape
    return energy


@pytest.mark.parametrize(
    "torque",
    [
        0.4 * np.gradient(_VELOCITY, _DT),
        0.3 * np.cos(_POSITION) - 0.8 * np.sin(_POSITION) + 0.2,
        0.2 * _SENSE + 0.5 * _VELOCITY,
        np.maximum(_SENSE, 0.0) * 0.4 * np.exp(-((_VELOCITY / 0.05) ** 2)),
    ],
    ids=["inertia", "gravity and offset", "coulomb and viscous", "static in one direction"],
)
def test_what_parameters_of_a_plain_joint_take_up_leaves_no_energy(torque: FloatArray) -> None:
    """But for half a sample, by which a mean until the next one is off."""
    assert np.sum(_energy(torque)) < 1e-3 * np.sum((torque / 0.1) ** 2)


def test_a_stop_shows_where_it_is_touched_and_not_where_its_refit_bends_the_rest() -> None:
    torque = 40.0 * np.maximum(_POSITION - 0.9, 0.0)
    energy, touched = _energy(torque), torque > 0.0
    assert 0.01 < np.mean(touched) < 0.1
    assert np.sum(energy[touched]) > 0.7 * np.sum(energy)
    assert np.mean(energy[touched]) > 50.0 * np.mean(energy[~touched])


def test_where_the_bristle_holds_a_torque_below_one_step_of_the_encoder_is_no_trace() -> None:
    """A step of 1e-4 rad on 4e4 N·m/rad is 1.15 N·m; a row at rest half as loud says less than a quiet one sliding."""
    resting = (_TIME > 6.0) & (_TIME < 7.0)
    torque = np.where(resting, 0.6, 0.2) * np.sin(40.0 * _TIME)
    position = _DT * np.cumsum(np.where(resting, 0.0, _VELOCITY))
    loud, fair = _energy(torque, position=position), _energy(torque, position=position, resolution=1e-4)
    assert np.mean(loud[resting]) > 5.0 * np.mean(loud[~resting])
    assert np.mean(fair[resting]) < 0.2 * np.mean(fair[~resting])


def test_what_nulls_know_badly_of_one_row_is_no_trace() -> None:
    torque = 40.0 * np.maximum(_POSITION - 0.9, 0.0)
    rows = build_problem([Track.build(_DT, _POSITION, np.zeros_like(_TIME))], _PLANT, Observer()).grids[0].centres.size
    strayed = _energy(torque, spread=0.1 * np.random.default_rng(1).uniform(0.5, 1.5, rows))
    plain = _energy(torque)
    assert np.allclose(strayed / np.sum(strayed), plain / np.sum(plain), atol=1e-12)


def test_an_impact_shorter_than_the_way_between_rows_shows_when_it_happens() -> None:
    """Two joints that the observer holds differ in 10 ms of torque half way between two rows."""
    problem = build_problem([Track.build(_DT, _POSITION, np.zeros_like(_TIME))], _PLANT, Observer())
    at = int(np.sum(problem.grids[0].centres[130:132])) // 2
    kick = Contribution(additive=np.where(np.abs(np.arange(_TIME.size) - at) <= 5, 0.5, 0.0))

    def runs(of: Problem, *_: object) -> list[list[Observation]]:
        return of.observe_all([_PLANT, _PLANT], [[kick], [Contribution()]])

    structure = SimpleNamespace(unpack_plant=lambda theta: _PLANT, observe_with_and_without=runs)
    spreads = [np.full(problem.grids[0].centres.size, 0.1)]
    nulls = SimpleNamespace(weights=SimpleNamespace(spread=spreads))
    baseline = cast(Baseline, SimpleNamespace(problem=problem, nulls=nulls))
    (energy,) = compute_effect_energy(baseline, cast(Structure, structure), np.zeros(0), {"external_disturbance"})
    assert abs(int(np.argmax(energy)) - at) <= 1
    assert np.sum(energy[at - 15 : at + 16]) > 0.9 * np.sum(energy)
