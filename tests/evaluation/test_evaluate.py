"""The evaluator: errors of true models are those of the noise, and code of the tests' own finds the same figures."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import fricomp
from fricomp.errors import ModelFileError, ParameterError, RecordingError
from fricomp.evaluation import Evaluation, evaluate
from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    FrictionLaw,
    LaggedStribeck,
    LoadCoulomb,
    LuGre,
    StribeckCurve,
    Viscous,
)
from fricomp.model import FrictionModel, JointDynamics, save_model
from fricomp.recording import Recording

from .made_joint import (
    COGGING,
    DT,
    FORWARD,
    GRAVITY,
    INERTIA,
    KINDS,
    LAG,
    LOAD,
    NOISE,
    REVERSE,
    SIGMA,
    Made,
    make_joint,
    torque_error,
)

CURVES = StribeckCurve(**FORWARD), StribeckCurve(**REVERSE)
DYNAMICS = JointDynamics(INERTIA, *GRAVITY)
LAWS = {
    "null": FrictionLaw((BidirectionalStribeck(*CURVES),)),
    "load": FrictionLaw((BidirectionalStribeck(*CURVES), LoadCoulomb(LOAD))),
    "cogging": FrictionLaw((BidirectionalStribeck(*CURVES), Cogging(*COGGING))),
    "presliding": FrictionLaw((LuGre(*CURVES, *SIGMA),)),
    "lag": FrictionLaw((LaggedStribeck(*CURVES, lag=LAG),)),
}


@cache
def _made(kind: str) -> Made:
    return make_joint(kind)


def _recording(made: Made) -> Recording:
    return Recording(made.time, made.position, made.torque)


def _model(kind: str) -> FrictionModel:
    return FrictionModel(LAWS[kind], dynamics=DYNAMICS)


@cache
def _evaluated(kind: str) -> Evaluation:
    """The true model on its own recording."""
    return evaluate(_model(kind), _recording(_made(kind)))


@pytest.mark.parametrize("kind", KINDS)
def test_a_true_model_leaves_no_more_than_the_noise_in_the_band(kind: str) -> None:
    found = _evaluated(kind)
    noise = NOISE * (found.torque.band / (0.5 / DT)) ** 0.5
    assert noise < found.torque.rms < 2.5 * noise  # about reversals the low-pass blurs what jumps


@pytest.mark.parametrize("kind", KINDS)
def test_a_true_model_moves_as_recorded(kind: str) -> None:
    found = _evaluated(kind)
    assert [one.after for one in found.position] == [0.1, 0.5, 2.0]
    for one, share in zip(found.position, (0.005, 0.005, 0.005), strict=True):
        assert one.median < share * one.travel
        assert one.ci95_median[0] <= one.median <= one.ci95_median[1]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("off", [1.0, 1.25])
def test_equations_of_the_tests_find_the_same_torque_error(kind: str, off: float, tmp_path: Path) -> None:
    law = LAWS[kind]
    moved = law.replace({name: off * value for name, value in law.parameters().items() if "coulomb_torque" in name})
    path = tmp_path / "friction.json"
    save_model(replace(_model(kind), law=moved), path)
    found = evaluate(path, _recording(_made(kind)))
    assert torque_error(path, _made(kind), found.torque.band) == pytest.approx(found.torque.rms, rel=0.03)


def test_a_wrong_model_is_further_off_in_torque_and_motion() -> None:
    right, wrong = _evaluated("load"), evaluate(_model("null"), _recording(_made("load")))
    assert wrong.torque.rms > 10.0 * right.torque.rms
    for good, bad in zip(right.position, wrong.position, strict=True):
        assert bad.median > 5.0 * good.median


def test_a_model_that_is_no_better_than_none_is_told_so() -> None:
    dull = replace(_model("null"), dynamics=replace(DYNAMICS, gravity_sine=-4.0 * max(map(abs, GRAVITY))))
    assert "no better than none" in evaluate(dull, _recording(_made("null"))).notes[-1]
    assert "no better than none" not in "".join(_evaluated("null").notes)


def test_times_without_a_sample_are_refused_and_short_ones_have_no_positions() -> None:
    recording = _recording(_made("null"))
    with pytest.raises(RecordingError, match="its end has to come later"):
        evaluate(_model("null"), recording, spans=[(9.0, 5.0)])
    with pytest.raises(RecordingError, match="the recording lasts from 0 to"):
        evaluate(_model("null"), recording, spans=[(900.0, 950.0)])
    short = evaluate(_model("null"), recording, spans=[(5.0, 5.08)])
    assert not short.position
    assert "No position errors" in "".join(short.notes)


def test_data_frames_and_results_are_taken_and_other_things_refused_by_their_type() -> None:
    recording = _recording(_made("null"))
    assert evaluate(SimpleNamespace(model=_model("null")), recording.to_pandas()).torque == _evaluated("null").torque
    with pytest.raises(ParameterError, match="Recording is no friction model"):
        evaluate(recording, _model("null"))  # type: ignore[arg-type]
    with pytest.raises(RecordingError, match="NoneType is no recording"):
        evaluate(_model("null"), None)  # type: ignore[arg-type]


def test_a_joint_that_friction_holds_stays_exactly_where_it_is() -> None:
    t = np.arange(0.0, 8.0, DT)
    position = np.where(t < 4.0, np.sin(2.0 * np.pi * 0.5 * t), 0.0)
    torque = np.where(t < 4.0, 0.0, 0.2 * np.sin(40.0 * t))
    recording = Recording(t, position, torque)
    model = FrictionModel(FrictionLaw((Coulomb(0.3), Viscous(0.1))), dynamics=JointDynamics(1e-5))
    from fricomp.evaluation import read_model, read_motion

    joint, part = read_model(model), read_motion(recording).parts[0]
    along = joint.follow(part, 1e-3)
    start = np.array([int(5.0 / DT)])
    reached = joint.simulate(part, along, start, [50, 500])
    assert np.max(np.abs(reached - part.position[start])) < 1e-9


def test_only_the_time_that_is_asked_for_counts() -> None:
    made = _made("null")
    spoilt = made.torque + 0.5 * (made.time > 10.0)
    recording = Recording(made.time, made.position, spoilt)
    before, behind = (evaluate(_model("null"), recording, spans=[span]) for span in ((0.0, 9.5), (10.5, 16.0)))
    assert before.torque.rms < 0.01
    assert behind.torque.rms == pytest.approx(0.5, rel=0.05)
    assert behind.position[0].median > 20.0 * before.position[0].median


def test_a_recorded_velocity_is_the_state_unless_it_is_late() -> None:
    made = _made("null")
    true = Recording(made.time, made.position, made.torque, velocity=made.velocity)
    late = Recording(made.time, made.position, made.torque, velocity=np.roll(made.velocity, 25))
    notes = [" ".join(evaluate(_model("null"), one).notes) for one in (true, late)]
    assert "starting states are recorded" in notes[0]
    assert "starting states are estimated" in notes[1]


def test_a_gap_is_not_bridged() -> None:
    made = _made("null")
    kept = (made.time < 6.0) | (made.time > 9.0)
    rows = Recording(made.time[kept], made.position[kept], made.torque[kept])
    found = evaluate(_model("null"), rows)
    assert found.torque.rms < 0.01
    assert found.position[0].median < 1e-3


def test_a_torque_that_is_known_to_be_late_is_moved_to_its_instant() -> None:
    made, delay = _made("null"), 0.01
    late = Recording(made.time, made.position, np.interp(made.time - delay, made.time, made.torque))
    plain = evaluate(_model("null"), late)
    model = FrictionModel(LAWS["null"], dynamics=replace(DYNAMICS, torque_delay=delay))
    assert evaluate(model, late).torque.rms < 0.3 * plain.torque.rms


def test_the_figures_are_there_as_json_and_as_text() -> None:
    found = evaluate(_model("null"), _recording(_made("null")))
    assert isinstance(found, Evaluation)
    assert found.to_json()["torque"]["rms"] == found.torque.rms
    assert "Torque error in the band from 0 to" in found.summary()
    assert fricomp.evaluate is evaluate


def test_what_cannot_be_evaluated_says_what_to_do(tmp_path: Path) -> None:
    recording = _recording(_made("null"))
    with pytest.raises(ModelFileError, match=r"give the simulation that has them"):
        evaluate(FrictionModel(LAWS["null"]), recording)
    with pytest.raises(ModelFileError, match=r"there is no model .*: give friction\.json"):
        evaluate(tmp_path / "nothing.json", recording)
    with pytest.raises(RecordingError, match=r"give a recording in the model's unit"):
        evaluate(_model("null"), recording.with_metadata(torque_unit="A"))
    with pytest.raises(RecordingError, match=r"give up to 200"):
        evaluate(_model("null"), recording, band=300.0)
    with pytest.raises(RecordingError, match=r"needs a longer one"):
        evaluate(_model("null"), recording.window(0.0, 0.5))
    with pytest.raises(RecordingError, match=r"needs a motion"):
        evaluate(_model("null"), recording.with_channels(position=np.zeros(len(recording))))


def test_a_simulation_that_runs_away_warns_nobody_and_leaves_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    import mujoco

    from fricomp.mujoco_warnings import silence_mujoco

    monkeypatch.chdir(tmp_path)
    heard: list[str] = []
    mujoco.set_mju_user_warning(heard.append)
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    try:
        for quiet in (True, False):
            data = mujoco.MjData(model)
            data.qfrc_applied[0] = 1e30
            with silence_mujoco() if quiet else nullcontext():
                mujoco.mj_step(model, data)
            assert bool(heard) is not quiet
    finally:
        mujoco.set_mju_user_warning(None)
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []
