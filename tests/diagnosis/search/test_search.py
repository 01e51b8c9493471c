"""What the search finds in recordings of a joint whose physics is known."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from fricomp.diagnosis.effects.structure import Structure
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.joint.solver import Box
from fricomp.diagnosis.search import search as module
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.diagnosis.search.search import _select_wholes, search
from fricomp.recording import Recording

from ..known import known, known_baseline, known_fit
from ..toy_joint import ToyJoint, record


def test_what_leaves_far_less_than_the_chosen_one_is_taken_apart_too() -> None:
    chosen = known(("spring_torque",), 5000.0)
    little = known(("encoder_eccentricity", "spring_torque"), 5100.0)
    far = known(("encoder_eccentricity", "spring_torque", "supply_sag"), 5400.0)
    refused = known(("end_stop", "spring_torque"), 6000.0, refused="the stop would pull outwards")
    assert _select_wholes([chosen, little, refused], chosen, 30.0, []) == [chosen]
    assert _select_wholes([chosen, little, refused, far], chosen, 30.0, []) == [chosen, far]
    assert _select_wholes([chosen, little, refused, far], chosen, 30.0, [chosen]) == [far]
    assert _select_wholes([refused], None, 30.0, []) == []


def test_effects_that_do_nothing_are_left_out_from_where_their_explanation_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    baseline = known_baseline()
    names = (("drive_lag", "load_coulomb", "torque_delay"), ("drive_lag", "load_coulomb"), ("load_coulomb",))
    whole, pair, alone = (known_fit(baseline, one, 900.0) for one in names)
    started: list[tuple[tuple[str, ...], object]] = []

    def note(_: Baseline, wanted: Sequence[tuple[Structure, FloatArray]], __: Box) -> list[Explanation]:
        started.extend((structure.names, structure.contexts) for structure, _ in wanted)
        return []

    monkeypatch.setattr(module, "fit_from", note)
    monkeypatch.setattr(module, "_list_idle", lambda _, one: ("drive_lag",) if "drive_lag" in one.names else ())
    module._fit_without_idle(baseline, [whole, pair, alone, pair])
    assert started == [
        (("load_coulomb", "torque_delay"), whole.structure.contexts),
        (("load_coulomb",), pair.structure.contexts),
    ]


@pytest.mark.slow
def test_a_soft_bristle_is_found_beside_a_stronger_effect() -> None:
    """The base makes up for it by a bristle at its bound, so that its column is faint."""
    joint = ToyJoint(sigma_0=2.2 / 6e-4, quadratic_drag=0.5)
    columns = record(joint, "rich", 20.0)
    recording = Recording(columns["time"], columns["position"], columns["torque"])
    found = search(prepare(build_tracks([recording]), observer=Observer(), nulls=12, seed=0))
    assert found.best is not None
    assert found.best.names == ("presliding_hysteresis", "quadratic_drag")


@pytest.mark.slow
def test_a_late_torque_is_found_beside_another_effect() -> None:
    """The base makes up for a part of it by a delay at its bound, whose own column hides that of a longer one."""
    columns = record(ToyJoint(delay_samples=3, cogging=(0.1, 12.0)), "rich", 20.0)
    recording = Recording(columns["time"], columns["position"], columns["torque"])
    found = search(prepare(build_tracks([recording]), observer=Observer(), nulls=12, seed=0))
    assert found.best is not None
    assert found.best.names == ("cogging", "torque_delay")


@pytest.mark.slow
def test_a_soft_bristle_is_found_beside_friction_under_load() -> None:
    """The base bends its gravity to make up for such friction: the load of the pair is that of another joint."""
    joint = ToyJoint(sigma_0=1.5e3, sigma_1=3.0, load_coulomb=0.3)
    columns = record(joint, "fourier", 20.0)
    recording = Recording(columns["time"], columns["position"], columns["torque"])
    found = search(prepare(build_tracks([recording]), observer=Observer(), nulls=12, seed=0))
    assert found.best is not None
    assert found.best.names == ("load_coulomb", "presliding_hysteresis")
    assert found.best.values["load_coulomb"]["coefficient"] == pytest.approx(joint.load_coulomb, rel=0.05)
