"""The band that is compared: it is chosen once more when what was missing is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.coordinates import ArmModel
from fricomp.arm.equations import ArmEquations, build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.fit import ArmFit
from fricomp.arm.friction import JointForm
from fricomp.arm.identification import ArmSearch
from fricomp.arm.prior import ArmPrior
from fricomp.arm.robust_fit import fit_robustly
from fricomp.arm.rows import build_rows
from fricomp.arm.search.gear import YIELDING_GEAR, GearSearch
from fricomp.arm.search.gear_motion import GearMotion
from fricomp.arm.search.judge import JointJudges
from fricomp.arm.search.shared_delay import SharedDelay, measure_delay
from fricomp.arm.timing import delay_correction, ripple_band
from fricomp.arm.timing.bandwidth import choose_again, choose_rows
from fricomp.arm.timing.gear_band import choose_lower

from .moving_arm import bend_gear, record_arm, write_arm
from .test_examination import follow_load


def test_a_wider_band_is_taken_where_what_was_found_leaves_far_less(tmp_path: Path) -> None:
    simulation, prior = write_arm(tmp_path), ArmPrior()
    arm, recording = match_recordings(record_arm(simulation, follow_load, duration=15.0, rate=100.0), simulation)
    model = ArmModel((JointForm().with_term("load_coulomb", 0), JointForm(), JointForm()))
    rows = build_rows(arm, recording, 1.25)
    bare = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    fit, equations = fit_robustly(arm, rows, bare, model, prior)
    noise = equations.weights.noise
    assert choose_again(rows, equations, fit, recording, prior, noise) is None
    higher = choose_again(rows, equations, fit, recording, prior, 3.0 * noise)
    assert higher is not None
    assert higher[0].cutoff >= 5.0


def test_a_delay_stands_in_another_band_until_what_was_found_beside_it_is_found_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Measured beside a plain model, what is missing would move it."""
    simulation, prior = write_arm(tmp_path), ArmPrior()
    recordings = record_arm(simulation, follow_load, duration=10.0, rate=100.0, delay=0.004)
    arm, recording = match_recordings(recordings, simulation)
    rows, equations = choose_rows(arm, recording, ArmModel.build_plain(3), prior)
    search = ArmSearch(arm, recording, prior, lambda _: None)
    first = search.run(rows, equations, ArmModel.build_plain(3), SharedDelay(0.0, 0.0, {}))
    assert first.delay.value == pytest.approx(0.004, abs=5e-4)
    seen: list[tuple[JointForm, ...]] = []

    def look(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> SharedDelay:
        seen.append(fit.model.forms)
        return measure_delay(equations, fit, prior)

    monkeypatch.setattr(delay_correction, "measure_delay", look)
    again = search.search_again(rows, equations, first)
    assert any("load_coulomb" in form.names for form in seen[0])
    assert again.delay.value == pytest.approx(first.delay.value, abs=5e-4)


@pytest.mark.parametrize(("bends", "is_other"), [(False, True), (True, False)])
def test_a_gear_that_encoders_make_is_another_one_in_half_of_the_band(
    tmp_path: Path, *, bends: bool, is_other: bool
) -> None:
    """Noise of their steps grows with the square of the frequency, and looks like a load that follows its motor."""
    stiffness, rotors = 400.0, (0.3, 0.2, 0.1) if bends else (30.0, 20.0, 10.0)
    simulation, prior = write_arm(tmp_path, rotors=rotors), ArmPrior()
    bend = bend_gear(1, stiffness, "motor") if bends else None
    arm, recording = match_recordings(record_arm(simulation, duration=20.0, rate=125.0, bend=bend), simulation)
    rows = build_rows(arm, recording, 20.0)
    model = ArmModel((JointForm(), JointForm().with_term(YIELDING_GEAR, 0), JointForm()))
    plain = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    rigid, equations = fit_robustly(arm, rows, plain, ArmModel.build_plain(3), prior)
    search = GearSearch(GearMotion(rows, rigid), "spring")
    equations = search.propose(equations, rigid, prior, JointJudges(equations, rigid))
    assert equations.gears["spring"][1, 1] > 0.0
    fit, equations = fit_robustly(arm, rows, equations, model, prior, rigid)
    lower = choose_lower(rows, equations, fit, recording, prior)
    assert (lower is not None) is is_other
    assert lower is None or lower[0].cutoff == 10.0


def test_a_ripple_takes_no_band_that_tells_links_and_rotors_much_worse(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Steps of a coarse encoder come again over the position, and are most of what is left in a wide band."""
    simulation, prior = write_arm(tmp_path, rotors=(3.0, 2.0, 1.0)), ArmPrior()
    series, step = record_arm(simulation, duration=15.0, rate=100.0), 4e-3
    coarse = [one.with_channels(position=np.round(np.asarray(one.position) / step) * step) for one in series]
    arm, recording = match_recordings(coarse, simulation)
    rows = build_rows(arm, recording, 2.5)
    bare = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    fit, equations = fit_robustly(arm, rows, bare, ArmModel.build_plain(3), prior)
    look = ripple_band._fit_ripples
    monkeypatch.setattr(ripple_band, "_fit_ripples", lambda *given: look(*given)._replace(gain=100.0))
    assert ripple_band.find_ripples(rows, equations, fit, recording, prior) is None
