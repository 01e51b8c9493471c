"""A spring where gravity looks like one: named, or told beside the links that may stand for it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import ArmExamination, examine_arm
from fricomp.arm.uncertainty.alternatives import _share, find_alternatives
from fricomp.arm.uncertainty.averaging import average_links
from fricomp.arm.uncertainty.scatter import widen_covariance
from fricomp.laws import FloatArray

from ..moving_arm import record_arm, write_arm

STIFFNESS = 0.35


def pull(joint: int, q: FloatArray, v: FloatArray, _: FloatArray) -> FloatArray:
    """A spring in the joint whose gravity varies most: a third of its level of friction at a radian."""
    return STIFFNESS * q if joint == 0 else np.zeros_like(v)


@pytest.fixture(scope="module")
def healthy(tmp_path_factory: pytest.TempPathFactory) -> ArmExamination:
    simulation = write_arm(tmp_path_factory.mktemp("plain"))
    return examine_arm(record_arm(simulation), simulation)


def test_no_spring_is_told_of_where_the_motion_speaks_against_one(healthy: ArmExamination) -> None:
    assert [joint.possible_spring for joint in healthy.record.joints] == [None, None, None]


@pytest.mark.slow
def test_a_spring_that_links_may_stand_for_is_told_beside_them(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    record = examine_arm(record_arm(simulation, pull, noise=0.3), simulation).record
    assert [joint.effects for joint in record.joints] == [(), (), ()]
    spring = record.joints[0].possible_spring
    assert spring is not None
    assert spring.ci95[0] < STIFFNESS < spring.ci95[1]
    (told,) = (line for line in record.sentences if "a spring or cable" in line)
    assert told.startswith("shoulder: ")


def test_intervals_of_links_hold_those_beside_the_answer_alone(healthy: ArmExamination) -> None:
    found = healthy.answer.identification
    ends = average_links(found.fit, find_alternatives(found.equations, found.fit, found.prior))
    assert np.all(ends[:, :, 0] <= found.fit.inertia[:, :4])
    assert np.all(ends[:, :, 1] >= found.fit.inertia[:, :4])
    for link, own in zip(healthy.record.links, ends, strict=True):
        assert link.mass.ci95 == pytest.approx(tuple(own[0]))


def test_deviations_are_never_less_than_rows_promise(healthy: ArmExamination) -> None:
    found = healthy.answer.identification
    own = find_alternatives(found.equations, found.fit, found.prior).own
    wider = widen_covariance(own, found.equations, found.rows)
    assert np.all(np.diag(wider.covariance) >= (1.0 - 1e-9) * np.diag(own.covariance))
    assert np.any(np.diag(wider.covariance) > 1.01 * np.diag(own.covariance))


def test_a_link_that_would_do_in_place_of_one_that_is_off_is_told_and_in_the_interval(tmp_path: Path) -> None:
    """Along the axis of the wrist, torques tell what the hand and the lower arm weigh together, and no more."""
    text = write_arm(tmp_path).read_text(encoding="utf-8")
    simulation, moved = tmp_path / "on_axis.xml", tmp_path / "moved.xml"
    simulation.write_text(text.replace("0 0.01 0.06", "0 0 0"), encoding="utf-8")
    moved.write_text(text.replace("0 0.01 0.06", "0.06 0 0"), encoding="utf-8")
    record = examine_arm(record_arm(moved, duration=20.0), simulation).record
    told = {one.name: one.instead for one in record.links if one.state == "off"}
    assert set(told) <= {"lower", "hand"}
    (instead,) = told.values()
    assert {*told, *instead} == {"lower", "hand"}
    lower, hand = record.links[1].first_moment["x"], record.links[2].first_moment["x"]
    assert lower.ci95[0] < 2.5 * 0.02 < lower.ci95[1]
    assert hand.ci95[0] < 1.2 * 0.06 < hand.ci95[1]
    (line,) = (one for one in record.summary if one.startswith("Links that are off"))
    assert f"or {instead[0]} is off in its place" in line


def test_what_is_beyond_measure_more_probable_takes_all() -> None:
    """A gap that links made no law of was e²¹⁴³ times more probable than the answer: no number, and no answer."""
    assert _share([-1.0, 2143.0, 72.0]) == pytest.approx([0.0, 0.0, 1.0, 0.0])
