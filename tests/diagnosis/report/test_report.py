"""Report, tables and files of a diagnosis."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace as with_fields

from fricomp.calibration.sweep.motion_file import read_motion
from fricomp.diagnosis import (
    DIAGNOSIS_SCHEMA,
    Diagnosis,
    DiagnosisRecord,
    Distinguishability,
    Evidence,
    HeldOut,
    NamedEffect,
    NextExperiment,
    Quantity,
    Rival,
    RowSeries,
    load_diagnosis,
)
from fricomp.diagnosis.record.file_errors import FileErrors, ModelErrors
from fricomp.diagnosis.record.result import Change
from fricomp.diagnosis.record.sentence import describe_errors, write_sentences
from fricomp.diagnosis.report import (
    Units,
    WrittenDiagnosis,
    build_change_table,
    build_diagnosis_page,
    build_effect_table,
    build_error_table,
    build_location_table,
    build_residual_table,
    describe_next_step,
    draw_diagnosis_charts,
    format_quantity,
    write_diagnosis,
)
from fricomp.diagnosis.report.maps import draw_plane_chart
from fricomp.diagnosis.report.over_time import draw_time_chart
from fricomp.diagnosis.report.weighing import build_rival_table, draw_rival_chart
from fricomp.evaluation import PositionError, TorqueError
from fricomp.export import state_columns
from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, LaggedLuGre, LaggedStribeck, StribeckCurve
from fricomp.model import FrictionModel, Validity, load_model
from fricomp.report import HeatMap, Line

_CURVE = StribeckCurve(2.0, 2.8, 0.05, 1.1)
_JOINT = """<mujoco><worldbody><body><joint name="elbow" axis="0 1 0"/>
<inertial pos="0.2 0 0" mass="1" diaginertia="0.3 0.3 0.3"/></body></worldbody></mujoco>"""


def _series() -> RowSeries:
    rng = np.random.default_rng(0)
    t = np.linspace(0.0, 29.98, 1500)
    q, v = 0.8 * np.sin(t), 0.8 * np.cos(t)
    missing, noise = 0.3 * np.sin(50.0 * q), 0.02 * rng.standard_normal(t.size)
    since = np.mod(t, np.pi)
    return RowSeries(
        "recording 1", t, q, v, -q, 3.0 * np.cos(q), since, None, missing + noise, noise, np.full(1500, 0.02)
    )


def _map(values: np.ndarray) -> dict[str, np.ndarray]:
    edges = np.linspace(values.min(), values.max(), 13)
    excess = np.linspace(50.0, 100.0, 12)
    return {"edges": edges, "excess": excess, "lower": 0.8 * excess, "upper": 1.2 * excess}


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    """Cogging named on one recording, with every part of the evidence."""
    series = _series()
    effect = NamedEffect(
        name="cogging",
        kind="physics",
        parameters={
            "sine": Quantity(0.3, "N·m", (0.29, 0.31)),
            "cosine": Quantity(0.0, "N·m", (-0.01, 0.01)),
            "order": Quantity(50.0, "1/rad", (49.9, 50.1)),
        },
        indistinguishable_from=("kinematic_error",),
        location={"position": [(-0.5, 0.5)]},
        share=0.97,
        equation="tau = A sin(n q + phi)",
        sentence="a torque ripple is fixed in the angle",
    )
    held = HeldOut(
        rmse_before=0.21, rmse_after=0.021, noise_floor=0.02, unit="N·m", ci95_reduction=(0.88, 0.91), explained=0.97
    )
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict="missing_physics",
        effects=(effect,),
        sentences=("The simulation leaves out physics <here>.", "It is a ripple."),
        heldout=held,
        location={"velocity": [(-0.1, 0.1)]},
        next_experiment=NextExperiment(motion="motion.csv", separates=("cogging", "kinematic_error"), why="Go slowly."),
        noise_ratio=10.5,
        base={"inertia": Quantity(0.35, "kg·m²", (0.34, 0.36))},
        rivals=(
            Rival(effects=("cogging",), gain=5e4),
            Rival(effects=("end_stop",), gain=9.0, refused="pulls outwards"),
        ),
        distinguishability=Distinguishability(("cogging", "end_stop"), [[0.0, 0.9], [0.8, 0.0]]),
        recordings=("recording 1",),
        joint="elbow",
    )
    orders = np.arange(1.0, 100.0)
    evidence = Evidence(
        series=(series,),
        maps={"velocity": _map(series.velocity), "position": _map(series.position)},
        orders={"order": orders, "energy": np.exp(-((orders - 50.0) ** 2)), "after": 0.0 * orders},
        change_points=((10.0,),),
    )
    base = FrictionModel(
        FrictionLaw((BidirectionalStribeck(_CURVE, _CURVE),)), joint="elbow", validity=Validity(velocity=(-0.8, 0.8))
    )
    extended = base.with_law(FrictionLaw((*base.law.terms, Cogging(0.3, 0.0, 50.0))))
    t = np.arange(100) * 0.01
    motion = {"time": t, "position_reference": np.sin(t), "velocity_reference": np.cos(t)}
    return Diagnosis(record, evidence, base, extended, motion)


@pytest.fixture(scope="module")
def written(diagnosis: Diagnosis, tmp_path_factory: pytest.TempPathFactory, drawn_charts: None) -> WrittenDiagnosis:
    """The folder of that diagnosis, pictures drawn, with the friction in the simulation it was compared with."""
    place = tmp_path_factory.mktemp("diagnosis")
    (place / "joint.xml").write_text(_JOINT)
    return write_diagnosis(diagnosis, place / "out", simulation=place / "joint.xml", joint="elbow")


def test_every_part_of_the_evidence_has_its_chart(diagnosis: Diagnosis) -> None:
    expected = {"over-time-1", "where", "planes", "orders", "rivals", "distinguishability", "motion"}
    assert set(draw_diagnosis_charts(diagnosis)) == expected


def test_a_diagnosis_without_evidence_has_no_charts_and_still_a_page(tmp_path: Path) -> None:
    record = DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict="bad_data", sentences=("No motion.",))
    written = write_diagnosis(Diagnosis(record), tmp_path)
    assert [path.name for path in written.files] == ["diagnosis.json", "report.html"]
    assert "No motion." in (tmp_path / "report.html").read_text()


def test_the_table_has_period_and_amplitude_of_a_ripple(diagnosis: Diagnosis) -> None:
    table = build_effect_table(diagnosis.record)
    assert table is not None
    rows = {row[1]: row for row in table.rows}
    assert rows["period"][2:4] == ("0.12566 rad", "0.12541 to 0.12592")
    assert rows["amplitude"][2] == "0.300 N·m"
    assert table.rows[0][4:] == ("97%", "kinematic_error")


def test_a_ripple_of_two_recordings_has_an_amplitude_in_each(diagnosis: Diagnosis) -> None:
    first = diagnosis.record.effects[0]
    waves = {"sine_2": Quantity(0.3, "N·m", (0.29, 0.31)), "cosine_2": Quantity(0.4, "N·m", (0.39, 0.41))}
    both = with_fields(first, parameters=first.parameters | waves)
    table = build_effect_table(with_fields(diagnosis.record, effects=(both,)))
    assert table is not None
    rows = {row[1]: row for row in table.rows}
    assert (rows["amplitude"][2], rows["amplitude of recording 2"][2]) == ("0.300 N·m", "0.500 N·m")
    assert rows["sine of recording 2"][2] == "0.300 N·m"


def test_what_to_record_next_is_said_first_with_files_and_command(
    diagnosis: Diagnosis, written: WrittenDiagnosis
) -> None:
    text = re.sub(r"<script.*?</script>", "", (written.folder / "report.html").read_text(), flags=re.S)
    said = describe_next_step(diagnosis.record, written.folder)
    assert said is not None
    assert "cannot tell apart: cogging and kinematic_error." in said
    assert f"fricomp calibrate --backend … --motion {written.folder / 'motion.csv'} --out runs/next" in said
    assert text.index(said) < text.index("What was found")
    assert describe_next_step(with_fields(diagnosis.record, next_experiment=None)) is None


def test_the_noise_ratio_has_the_digits_of_the_sentence(diagnosis: Diagnosis) -> None:
    record = with_fields(diagnosis.record, noise_ratio=10.4478)
    page = build_diagnosis_page(replace(diagnosis, record=record), {}, (), {})
    assert page.facts["residual over its noise"] == "10.45"
    assert any("10.45 times its noise floor" in one for one in write_sentences(record))


def test_a_single_effect_has_one_line_of_where_it_sits(diagnosis: Diagnosis) -> None:
    (effect,) = diagnosis.record.effects
    for location, expected in ((effect.location, ["cogging"]), ({}, ["cogging"])):
        table = build_location_table(with_fields(diagnosis.record, location=location), Units())
        assert table is not None
        assert [row[0] for row in table.rows] == expected
    table = build_location_table(diagnosis.record, Units())
    assert table is not None
    assert [row[0] for row in table.rows] == ["the whole mismatch", "cogging"]


def test_the_order_of_a_filter_has_no_period_and_no_interval(diagnosis: Diagnosis) -> None:
    numbers = {"time_constant": Quantity(4e-3, "s", (3e-3, 5e-3)), "order": Quantity(2.0, "1", (2.0, 2.0))}
    lag = NamedEffect(name="drive_lag", kind="measurement", parameters=numbers, sentence="it lags")
    record = with_fields(diagnosis.record, effects=(lag,))
    table = build_effect_table(record)
    assert table is not None
    rows = {row[1]: row for row in table.rows}
    assert set(rows) == {"time constant", "order"}
    assert rows["order"][3] == "–"
    assert "order 2." in " ".join(write_sentences(record))


def test_friction_of_the_simulation_is_said_to_be_no_part_of_the_verdict(diagnosis: Diagnosis) -> None:
    captions = []
    for name in ("inertia", "damping"):
        change = Change(name=name, given=1.0, refitted=Quantity(2.0, "1", (1.9, 2.1)))
        table = build_change_table(with_fields(diagnosis.record, changes=(change,)))
        assert table is not None
        captions.append("no part of the verdict" in table.caption)
    assert captions == [False, True]


def test_the_whitened_residual_stands_beside_its_noise_floor(diagnosis: Diagnosis) -> None:
    table = build_residual_table(diagnosis.record)
    assert table is not None
    assert table.columns[0] == "whitened residual"
    assert [row[1] for row in table.rows] == ["0.21", "0.021", "0.02"]


def _errors(rms: float) -> ModelErrors:
    torque = TorqueError(
        rms=rms, ci95_rms=(0.9 * rms, 1.1 * rms), median=0.7 * rms, recorded=3.0, unit="N·m", band=25.0, duration=20.0
    )
    position = PositionError(
        after=0.1, median=0.01 * rms, ci95_median=(0.0, rms), rms=rms, travel=0.1, starts=100, unit="rad"
    )
    return ModelErrors(torque=torque, position=(position,))


def test_errors_of_the_files_are_told_in_the_units_of_the_recording(diagnosis: Diagnosis) -> None:
    errors = FileErrors(before=_errors(0.4), after=_errors(0.05), file=_errors(0.04), folds=4)
    record = with_fields(diagnosis.record, errors=errors)
    table = build_error_table(record)
    assert table is not None
    assert table.columns[1] == "torque, RMS [N·m]"
    assert [(row[0], row[1]) for row in table.rows[1:]] == [
        ("with what was named", "0.05"),
        ("friction.json, over all data", "0.04"),
    ]
    assert "0 to 25 Hz" in table.caption
    (said,) = describe_errors(errors)
    assert "the torque error falls from 0.4 to 0.05 N·m (in the band up to 25 Hz" in said
    assert "off after 0.1 s by 0.0005 rad, before by 0.004 rad" in said
    missing = with_fields(errors, missing=("backlash",), after=None)
    assert "no term for backlash: what it leaves of the torque is 0.04 N·m" in describe_errors(missing)[1]


def test_parameters_that_are_off_are_drawn_as_given_and_refitted(diagnosis: Diagnosis) -> None:
    held = diagnosis.heldout
    assert held is not None
    record = with_fields(diagnosis.record, heldout=with_fields(held, before="given"))
    table, charts = build_residual_table(record), draw_diagnosis_charts(replace(diagnosis, record=record))
    assert table is not None
    assert [row[0] for row in table.rows[:2]] == ["named parameters as given, the rest refitted", "everything refitted"]
    for name in ("over-time-1", "where"):
        labels = [mark.label for mark in charts[name].panels[0].marks if isinstance(mark, Line)]
        assert labels == ["named parameters as given, the rest refitted", "everything refitted"]


def test_a_wide_band_at_reversals_leaves_the_rows_to_be_seen() -> None:
    series = _series()
    spread = np.where(series.time_since_reversal < 0.05, 5.0, 0.02)
    residual = draw_time_chart(replace(series, spread=spread), Units(), 1, ("base model",)).panels[0]
    assert residual.y_range is not None
    assert residual.y_range[1] == pytest.approx(1.1 * np.abs(series.before).max())


def test_a_part_whose_noise_is_unknown_is_drawn_without_a_warning() -> None:
    series = _series()
    unknown = draw_time_chart(replace(series, spread=np.full_like(series.spread, np.nan)), Units(), 1, ("base model",))
    reach = unknown.panels[0].y_range
    assert reach is not None
    assert reach[1] == pytest.approx(1.1 * np.abs(series.before).max())


@pytest.mark.parametrize(
    ("value", "interval", "text"),
    [
        (0.118, (0.112, 0.124), "0.1180 ± 0.0060 N·m"),
        (5071.7, (5064.5, 5078.9), "5071.7 ± 7.2 N·m"),
        (0.5, (0.5, 0.5), "0.5 N·m"),
        (2e-5, (1e-5, 3e-5), "2e-05 ± 1e-05 N·m"),
        (2.0, (0.0, 5e303), "not determined (about 2 N·m)"),
        (0.0, (-1.0, 1.0), "0.0 ± 1.0 N·m"),
    ],
)
def test_numbers_have_the_digits_that_their_interval_leaves(
    value: float, interval: tuple[float, float], text: str
) -> None:
    assert format_quantity(Quantity(value, "N·m", interval)) == text
    assert "not determined" in format_quantity(Quantity(value, "N·m", interval), determined=False)


def test_the_folder_holds_models_that_read_back_and_a_motion_that_can_be_recorded(
    diagnosis: Diagnosis, written: WrittenDiagnosis
) -> None:
    out = written.folder
    assert load_diagnosis(out / "diagnosis.json") == diagnosis.record
    assert diagnosis.extended_model is not None
    assert load_model(out / "friction.json").law == diagnosis.extended_model.law
    assert 'joint="elbow"' in (out / "friction.xml").read_text()
    motion = read_motion(out / "motion.csv")
    np.testing.assert_allclose(motion.velocity, np.cos(motion.time), rtol=1e-8)
    assert all(path.stat().st_size > 1000 for path in written.files if path.suffix == ".png")


def test_the_graph_of_an_extended_law_takes_what_the_law_needs(diagnosis: Diagnosis, written: WrittenDiagnosis) -> None:
    onnxruntime = pytest.importorskip("onnxruntime")
    model = diagnosis.extended_model
    assert model is not None
    session = onnxruntime.InferenceSession(str(written.folder / "friction.onnx"))
    assert session.get_modelmeta().custom_metadata_map["input"].startswith(", ".join(state_columns([model])))
    velocity, position = np.linspace(-0.8, 0.8, 41), np.linspace(-2.0, 2.0, 41)
    state = np.column_stack([velocity, np.ones(41), position, np.full(41, 2.5), np.full(41, 25.0)]).astype(np.float32)
    torque = session.run(None, {session.get_inputs()[0].name: state})[0][:, 0]
    np.testing.assert_allclose(torque, model.torque(velocity, position=position, load_torque=2.5), atol=2e-5)


def test_the_network_of_a_law_of_velocity_alone_is_that_law(diagnosis: Diagnosis, tmp_path: Path) -> None:
    onnxruntime = pytest.importorskip("onnxruntime")
    plain = replace(diagnosis, evidence=Evidence(), extended_model=None, motion=None)
    write_diagnosis(plain, tmp_path)
    session = onnxruntime.InferenceSession(str(tmp_path / "friction.onnx"))
    velocity = np.linspace(-0.8, 0.8, 41)
    state = np.column_stack([velocity, np.ones(41)]).astype(np.float32)
    torque = session.run(None, {session.get_inputs()[0].name: state})[0][:, 0]
    assert diagnosis.base_model is not None
    np.testing.assert_allclose(torque, diagnosis.base_model.torque(velocity), atol=1e-5)


def test_the_notes_tell_what_the_friction_law_cannot_hold(diagnosis: Diagnosis, tmp_path: Path) -> None:
    springy = with_fields(diagnosis.record.effects[0], name="joint_elasticity")
    record = with_fields(diagnosis.record, effects=(*diagnosis.record.effects, springy))
    plain = replace(diagnosis, record=record, evidence=Evidence(), motion=None)
    expected = "friction.json: the extended friction law: stribeck + cogging; without joint_elasticity, "
    assert write_diagnosis(plain, tmp_path).notes[0].startswith(expected)
    base_only = replace(plain, extended_model=None)
    assert "without cogging, joint_elasticity" in write_diagnosis(base_only, tmp_path).notes[0]


@pytest.mark.parametrize("with_bristle", [True, False])
def test_friction_that_lags_stands_in_the_law_and_a_bristle_only_where_it_has_one(
    with_bristle: bool, diagnosis: Diagnosis, tmp_path: Path
) -> None:
    names = ("frictional_lag", "presliding_hysteresis")
    effects = tuple(with_fields(diagnosis.record.effects[0], name=name) for name in names)
    model = diagnosis.base_model
    assert model is not None
    curves = model.forward, model.reverse
    term = LaggedLuGre(*curves, 500.0, lag=8e-3) if with_bristle else LaggedStribeck(*curves, lag=8e-3)
    record = with_fields(diagnosis.record, effects=effects)
    plain = replace(diagnosis, record=record, extended_model=model.with_law(FrictionLaw((term,))))
    note = write_diagnosis(replace(plain, evidence=Evidence(), motion=None), tmp_path).notes[0]
    without = "" if with_bristle else "; without presliding_hysteresis, for which no term is written"
    assert note == f"friction.json: the extended friction law: {term.name}{without}."


def test_a_torque_in_amperes_is_no_mjcf(diagnosis: Diagnosis, tmp_path: Path) -> None:
    assert diagnosis.base_model is not None
    amperes = replace(diagnosis, base_model=replace(diagnosis.base_model, torque_unit="A"), extended_model=None)
    amperes = replace(amperes, evidence=Evidence(), motion=None)
    written = write_diagnosis(amperes, tmp_path)
    assert any("friction.xml is not written" in note and " A" in note for note in written.notes)


def test_sentences_come_first_and_nothing_is_loaded_from_elsewhere(written: WrittenDiagnosis) -> None:
    text = (written.folder / "report.html").read_text()
    body = re.sub(r"<script.*?</script>", "", text, flags=re.S)
    assert body.index("The simulation leaves out physics &lt;here&gt;.") < body.index("What was found")
    assert not re.findall(r"<(?:script|link|img|iframe)\b[^>]*(?:src|href)=", body)


def test_verdicts_of_one_word_have_a_title(diagnosis: Diagnosis, tmp_path: Path) -> None:
    record = with_fields(diagnosis.record, verdict="consistent", effects=(), sentences=("Nothing is missing.",))
    write_diagnosis(Diagnosis(record, base_model=diagnosis.base_model), tmp_path)
    assert "<h1>Joint elbow: nothing is missing</h1>" in (tmp_path / "report.html").read_text()


def test_what_cannot_be_told_from_what_was_named_is_not_called_refused(diagnosis: Diagnosis) -> None:
    rivals = (
        Rival(effects=("cogging",), gain=5e4),
        Rival(effects=("kinematic_error",), gain=4.9e4, refused="another explanation is better or simpler"),
        Rival(effects=("end_stop",), gain=9.0, refused="pulls outwards"),
    )
    table = build_rival_table(rivals, diagnosis.record.effects)
    assert table is not None
    assert [row[-1] for row in table.rows] == ["named", "cannot be told from what was named", "pulls outwards"]
    chart = draw_rival_chart(rivals, diagnosis.record.effects)
    assert chart is not None
    assert chart.panels[0].has_lone_bars()


@pytest.mark.parametrize(("models", "scales"), [(("one", "two"), [False, True] * 2), (("one",), [True] * 2)])
def test_maps_side_by_side_share_one_colour_scale(
    diagnosis: Diagnosis, models: tuple[str, ...], scales: list[bool]
) -> None:
    chart = draw_plane_chart(diagnosis.evidence.series, Units(), models)
    assert chart is not None
    maps = [mark for panel in chart.panels for mark in panel.marks if isinstance(mark, HeatMap)]
    assert [bool(mark.color_label) for mark in maps] == scales


@pytest.mark.slow
def test_a_browser_draws_every_chart_without_errors_or_a_network(
    diagnosis: Diagnosis, written: WrittenDiagnosis, open_page: Callable[[Path], Any]
) -> None:
    shown = open_page(written.folder / "report.html")
    assert (shown.complaints, shown.fetched) == ((), ())
    for name in draw_diagnosis_charts(diagnosis):
        drawn = shown.dom[shown.dom.index(f'id="chart-{name}"') :][:200_000]
        assert 'class="subplot xy"' in drawn, name


def test_the_only_joint_of_a_simulation_gets_the_friction_whatever_the_recording_calls_it(
    diagnosis: Diagnosis, tmp_path: Path
) -> None:
    simulation = tmp_path / "arm.xml"
    simulation.write_text('<mujoco><worldbody><body><joint name="hinge"/></body></worldbody></mujoco>', "utf-8-sig")
    plain = replace(diagnosis, evidence=Evidence(), motion=None)
    write_diagnosis(plain, tmp_path / "why", simulation=simulation)
    assert 'joint="hinge"' in (tmp_path / "why/friction.xml").read_text()
