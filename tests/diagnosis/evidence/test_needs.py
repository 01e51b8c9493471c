"""What a name needs: numbers that are not those of its absence, and no end of a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.effects.effect import compute_lowest_order
from fricomp.diagnosis.effects.structure import N_BASE, Candidate, Structure
from fricomp.diagnosis.evidence.needs import find_one_way, list_objections
from fricomp.diagnosis.evidence.refitted import RefittedJoint
from fricomp.diagnosis.evidence.undetermined import list_undetermined

from ..known import known_baseline, known_fit


def _refitted(name: str, deviation: float, **values: float) -> RefittedJoint:
    """A base with one effect, whose numbers are known to a deviation."""
    baseline = known_baseline()
    structure = Structure(baseline.structure.contexts, (Candidate(name, tuple(values.items())),))
    one = replace(known_fit(baseline, [name], 100.0), structure=structure)
    theta = np.concatenate([baseline.fit.theta, structure.build_start()])
    fit = replace(one.fit, theta=theta, jacobian=np.zeros((baseline.fit.residual.size, theta.size)))
    covariance = np.diag(np.concatenate([np.zeros(N_BASE), np.full(theta.size - N_BASE, deviation**2)]))
    return RefittedJoint(structure, fit, covariance)


def test_a_size_whose_interval_holds_zero_is_no_name() -> None:
    assert "holds zero" in list_objections(_refitted("load_coulomb", 0.1, coefficient=0.1))["load_coulomb"]
    assert list_objections(_refitted("load_coulomb", 0.02, coefficient=0.1)) == {}
    assert list_objections(_refitted("load_coulomb", 0.1, coefficient=0.1), {"load_coulomb"}) == {}


@pytest.mark.parametrize(("deviation", "named"), [(0.07, True), (0.15, False)])
def test_an_exponent_is_open_by_the_recording_and_not_by_how_forms_differ(deviation: float, named: bool) -> None:
    found = _refitted("power_law_viscous", deviation, coefficient=1.0, exponent=0.62)
    objections = list_objections(found)
    assert objections == {} if named else "not determined" in objections["power_law_viscous"]
    assert ("power_law_viscous.exponent" in list_undetermined(found, ("N·m", "rad"))) == (not named)


def test_waves_that_make_up_for_each_other_are_no_name() -> None:
    numbers = {"sine": 0.02, "cosine": 0.02, "order": 1.0, "sine_overtone_2": 0.02, "cosine_overtone_2": 0.02}
    known, found = (_refitted("encoder_eccentricity", one, **numbers) for one in (0.002, 0.02))
    names = [n for n, (owner, p) in enumerate(found.structure.parameters, N_BASE) if p.name.startswith(("sine", "cos"))]
    tied = found.covariance.copy()
    tied[np.ix_(names, names)] = 0.02**2 * (np.eye(len(names)) - np.full((len(names),) * 2, 0.99 / len(names)))
    assert list_objections(known) == {}
    assert "make up for each other" in list_objections(replace(found, covariance=tied))["encoder_eccentricity"]


def test_both_parts_of_a_wave_are_judged_together() -> None:
    assert list_objections(_refitted("cogging", 0.1, sine=0.2, cosine=0.2, order=40.0)) == {}
    assert list_objections(_refitted("cogging", 0.1, sine=0.15, cosine=0.1, order=40.0))


def test_a_ripple_whose_period_may_be_longer_than_the_range_is_no_name() -> None:
    lowest = compute_lowest_order(known_baseline().structure.contexts)
    sure, open_ = (_refitted("cogging", 0.05, sine=1.0, cosine=1.0, order=lowest + more) for more in (0.2, 0.08))
    assert list_objections(sure) == {}
    assert "no period" in list_objections(open_)["cogging"]


@pytest.mark.parametrize(("time", "named"), [(0.05, False), (0.08, False), (0.3, True)])
def test_friction_that_may_be_there_after_any_rest_does_not_grow_with_it(time: float, named: bool) -> None:
    numbers = {"rise": 2.0, "time_constant": float(np.log(time)), "travel": float(np.log(0.005))}
    objections = list_objections(_refitted("dwell_stiction", 0.4, **numbers))
    assert ("dwell_stiction" not in objections) == named
    assert named or "any rest" in objections["dwell_stiction"]


@pytest.mark.parametrize(("back", "refused"), [(0.0, {"supply_sag", "load_coulomb"}), (0.3, set())])
def test_a_motion_in_one_direction_shows_what_depends_on_the_angle_alone(back: float, refused: set[str]) -> None:
    (context,) = known_baseline().structure.contexts
    velocity = np.where(np.arange(context.velocity.size) < back * context.velocity.size, -1.0, 1.0)
    one_way = find_one_way(("cogging", "supply_sag", "load_coulomb"), [velocity])
    assert set(one_way) == refused


def test_an_exponent_near_that_of_the_base_is_no_name() -> None:
    assert list_objections(_refitted("stribeck_shape", 0.2, stribeck_exponent=2.3))
    assert list_objections(_refitted("stribeck_shape", 0.05, stribeck_exponent=1.0)) == {}


def test_a_number_at_the_end_of_the_search_is_no_name() -> None:
    at_end = list_objections(_refitted("stribeck_shape", 0.01, stribeck_exponent=0.4))
    assert "end of what is looked for" in at_end["stribeck_shape"]
    curve = [_refitted("power_law_viscous", 0.01, coefficient=1.0, exponent=exponent) for exponent in (0.35, 0.6)]
    assert ["power_law_viscous" in list_objections(one) for one in curve] == [True, False]
    softest = list_objections(_refitted("presliding_hysteresis", 0.01, breakaway_distance=np.log(5e-2)))
    assert "breakaway distance" in softest["presliding_hysteresis"]


def test_the_interval_of_a_number_is_that_beside_those_that_end_where_their_domain_does() -> None:
    free, ended = (_tied("load_coulomb", coefficient=0.1, inertia_share=share) for share in (0.5, 1.0))
    assert free.list_parameters("load_coulomb", "", "")["coefficient"].ci95[0] < 0.0
    low, high = ended.list_parameters("load_coulomb", "", "")["coefficient"].ci95
    assert 0.05 < low < 0.1 < high < 0.15
    assert list_objections(ended) == {}


def test_a_size_that_hangs_together_with_a_time_is_judged_at_that_time() -> None:
    """Without heating its time constant means nothing, however open it leaves the size in the long run."""
    heating = _tied("torque_constant_heating", loss=0.15, time_constant=5.8)
    assert heating.list_parameters("torque_constant_heating", "", "")["loss"].ci95[0] < 0.0
    assert list_objections(heating) == {}
    assert list_objections(_tied("torque_constant_heating", loss=0.008, time_constant=5.8))


def test_no_interval_of_the_base_holds_friction_that_drives() -> None:
    found = _refitted("load_coulomb", 0.01, coefficient=0.1)
    wide = replace(found, covariance=np.eye(found.fit.theta.size))
    base = wide.list_base("N·m", "rad", wide.deviations[:N_BASE])
    assert all(base[f"{side}.{one}"].ci95[0] >= 0.0 for side in ("forward", "reverse") for one in _FRICTION)
    assert base["offset"].ci95[0] < 0.0


_FRICTION = ("coulomb_torque", "viscous_coefficient")


def _tied(name: str, **values: float) -> RefittedJoint:
    """A base with one effect of two numbers that hang together: neither is known without the other."""
    found = _refitted(name, 0.0, **values)
    tied = np.zeros_like(found.covariance)
    tied[-2:, -2:] = [[0.1**2, 0.0999 * 0.1], [0.0999 * 0.1, 0.1**2]]
    return replace(found, covariance=tied)


@pytest.mark.parametrize(("met", "told"), [(0.0, False), (0.2, True)])
def test_the_way_to_a_stop_that_nothing_meets_is_no_number(met: float, told: bool) -> None:
    (context,) = known_baseline().structure.contexts
    high, span = float(context.position.max()), float(np.ptp(context.position))
    stop = {"stiffness": 5.0, "damping": 0.0, "inertia": 0.0, "edge": high - 0.2 * span, "side": 1.0}
    one = _refitted("end_stop", 0.01, **stop, travel=(1.0 - met) * span)
    assert ("travel" in one.list_parameters("end_stop", "N·m", "rad")) == told
    assert list_objections(one) == {}
    assert "end_stop.travel" not in list_undetermined(one, ("N·m", "rad"))


@pytest.mark.parametrize(("deviation", "named"), [(0.3, True), (0.8, False)])
def test_a_gap_that_may_be_a_third_or_three_times_itself_is_no_name(deviation: float, named: bool) -> None:
    objections = list_objections(_refitted("backlash", deviation, gap=float(np.log(3e-3))))
    assert ("backlash" not in objections) == named
    assert named or "not determined" in objections["backlash"]


def test_friction_that_varies_along_a_short_way_needs_no_order_where_far_less_is_explained_without_it() -> None:
    open_ = _refitted("position_coulomb", 1.0, sine=0.4, cosine=0.2, order=1.5)
    assert "same everywhere" in list_objections(open_)["position_coulomb"]
    assert list_objections(open_, {"position_coulomb"}) == {}
