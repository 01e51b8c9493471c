"""Terms beside plain friction: what waves, warms or lags in one joint is named there, forms of one effect are one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import build_friction_model, examine_arm
from fricomp.arm.columns import turn_bristle
from fricomp.arm.confirmation import ConfirmedData
from fricomp.arm.friction import TERMS, JointForm, column_names, find_columns
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm
from .test_examination import names_of


def wave(joint: int, q: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
    return 0.25 * np.sin(13.0 * q + 0.4) if joint == 1 else np.zeros_like(q)


def test_a_ripple_is_named_with_its_order(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    found = examine_arm(record_arm(simulation, wave), simulation)
    assert names_of(found.record) == {"shoulder": [], "elbow": ["cogging"], "wrist": []}
    (effect,) = found.record.joints[1].effects
    low, high = effect.parameters["order"].ci95
    assert low < 13.0 < high
    size = np.hypot(effect.parameters["sine"].value, effect.parameters["cosine"].value)
    assert size == pytest.approx(0.25, abs=0.03)
    assert "cogging" in {term.name for term in build_friction_model(found.answer.identification, 1).law.terms}


@pytest.mark.slow
def test_friction_that_falls_with_the_temperature_is_named(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    series = record_arm(simulation)
    time = np.asarray(series[0].time)
    warmth = 15.0 * (1.0 - np.exp(-time / 20.0))
    velocity = np.gradient(np.asarray(series[0].position), time)
    cooler = np.asarray(series[0].torque) - 0.025 * warmth * velocity
    warm = [one.with_channels(temperature=25.0 + warmth) for one in series]
    record = examine_arm([warm[0].with_channels(torque=cooler), *warm[1:]], simulation).record
    assert names_of(record) == {"shoulder": ["thermal_friction"], "elbow": [], "wrist": []}
    assert record.joints[0].effects[0].parameters["viscous_slope"].value == pytest.approx(-0.025, abs=0.003)


@pytest.mark.slow
def test_the_torque_of_one_joint_that_comes_late_is_named_there(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    late = record_arm(simulation, delay=0.012)
    record = examine_arm([late[0], *record_arm(simulation, delay=0.002)[1:]], simulation).record
    assert names_of(record) == {"shoulder": ["torque_delay"], "elbow": [], "wrist": []}
    assert record.joints[0].effects[0].indistinguishable_from == ("drive_lag",)
    assert record.delay.value + record.joints[0].effects[0].parameters["delay"].value == pytest.approx(
        0.012, abs=1.5e-3
    )


def test_what_is_weak_is_named_by_means_over_which_noise_averages_out(tmp_path: Path) -> None:
    """Over 0.1 s it lowers the error by less than a tenth, over 0.2 s by more; no other joint has a name by that."""
    simulation = write_arm(tmp_path)
    wave = record_arm(simulation, lambda j, q, v, _: 0.13 * (j == 1) * np.cos(q) * np.sign(v), noise=0.3)
    examined = examine_arm(wave, simulation)
    assert names_of(examined.record) == {"shoulder": [], "elbow": ["position_coulomb"], "wrist": []}
    found = examined.answer.identification
    fit, data = found.fit, ConfirmedData(found.fit.arm, found.equations, found.prior, found.rows)
    (_, after, _), (_, before, _) = (
        data.measure_model(model, fit) for model in (fit.model, fit.model.without_terms(1, "position_coulomb"))
    )
    falls = 1.0 - after[:, 1] / before[:, 1]
    assert falls[0] < 0.1 < falls[-1]


def test_drag_is_no_stribeck_curve_that_falls_over_most_speeds(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    drag = record_arm(simulation, lambda j, _, v, __: 0.3 * (j == 1) * v * np.abs(v), noise=0.3)
    record = examine_arm(drag, simulation).record
    assert names_of(record) == {"shoulder": [], "elbow": ["quadratic_drag"], "wrist": []}


def test_a_second_form_of_an_effect_mends_the_first() -> None:
    form = JointForm((("load_coulomb", 0), ("stribeck", 1), ("load_quadratic", 0)))
    assert form.find_head("load_quadratic") == "load_coulomb"
    assert form.find_head("stribeck") == "stribeck"
    assert form.without_term("load_coulomb").names == ("stribeck",)
    assert form.without_term("load_quadratic").names == ("load_coulomb", "stribeck")


def test_columns_of_every_kind_have_a_place() -> None:
    places = [
        find_columns(filled) for filled in ("motion", "stribeck", "creep", "delay", "ripple", "gap", "spring", "load")
    ]
    assert [place.start for place in places[1:]] == [place.stop for place in places[:-1]]
    assert places[-1].stop == len(column_names())


def test_a_bristle_turns_as_dahl_has_it() -> None:
    """Beside steps of z' = v (1 - z sign v) / d, along a path that turns."""
    path = np.cumsum(np.concatenate([np.zeros(5), np.full(200, 1e-5), np.full(500, -1e-5), np.zeros(3)]))
    z, stepped = 0.0, []
    for step in np.diff(path, prepend=path[0]):
        z += step / 1e-3 * (1.0 - z * np.sign(step))
        stepped.append(z)
    assert turn_bristle(path, 1e-3) == pytest.approx(np.array(stepped), abs=0.02)
    assert np.all(turn_bristle(np.zeros(4), 1e-3) == 0.0)


def test_waves_a_turn_are_counted_and_a_distance_lies_between_those_that_were_tried() -> None:
    waves, bristle = TERMS["position_coulomb"], TERMS["presliding_hysteresis"]
    assert waves.bound_variant(0, rotary=True) == (1.0, 1.0)
    assert not waves.is_at_end(0)
    low, high = bristle.bound_variant(3, rotary=True)
    assert low < bristle.values[3] < high  # type: ignore[operator]
    assert [k for k in range(len(bristle.values)) if bristle.is_at_end(k)] == [0, len(bristle.values) - 1]
