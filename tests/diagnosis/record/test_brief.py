"""The short answer: what is wrong, where, and what to do come first; nothing that needs care is left out."""

from pathlib import Path

import pytest

from fricomp.cli.diagnosis.joint import DiagnosisRun, print_diagnosis
from fricomp.diagnosis import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord, NamedEffect, Quantity
from fricomp.diagnosis.record.brief import TOO_MUCH_LEFT
from fricomp.diagnosis.record.file_errors import FileErrors, ModelErrors
from fricomp.diagnosis.record.result import Change, Rival
from fricomp.diagnosis.record.sentence import Notes, write_record
from fricomp.evaluation.result import TorqueError

_WAVE = {
    "sine": Quantity(0.3, "N·m", (0.2, 0.4)),
    "cosine": Quantity(0.4, "N·m", (0.3, 0.5)),
    "order": Quantity(14.0, "1/rad", (13.9, 14.1)),
}
_RIPPLE = NamedEffect(name="cogging", kind="physics", parameters=_WAVE, sentence="a ripple", equation="A sin(n q)")
_LOAD = NamedEffect(
    name="load_coulomb",
    kind="physics",
    parameters={"coefficient": Quantity(0.1, "1", (0.08, 0.12))},
    indistinguishable_from=("load_quadratic",),
    location={"load_torque": [(1.0, 2.0)]},
    sentence="friction grows with the load",
)
_CHANGES = (
    Change(name="inertia", given=0.3, refitted=Quantity(0.42, "kg·m²", (0.4, 0.44))),
    Change(name="damping", given=0.0, refitted=Quantity(0.1, "N·m·s/rad", (0.09, 0.11))),
)
_NONE = Notes()


def _record(
    *effects: NamedEffect,
    verdict: str = "missing_physics",
    notes: Notes = _NONE,
    errors: FileErrors | None = None,
) -> DiagnosisRecord:
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=verdict,  # type: ignore[arg-type]
        effects=effects,
        changes=_CHANGES,
        location={"velocity": [(0.1, 0.2)]},
        noise_ratio=2.0,
        errors=errors,
        base={} if errors is None else {"inertia": Quantity(0.4, "kg·m²", (0.3, 0.5))},
    )
    return write_record(fields, notes)


def test_names_place_and_what_to_do_are_the_first_three_sentences() -> None:
    what, where, to_do, *rest = _record(_RIPPLE, _LOAD).summary
    assert what == "The simulation leaves out physics that this recording shows: cogging, load_coulomb."
    assert where.startswith("By effect: cogging in the rhythm of the position, at the order 14 1/rad; load_coulomb at")
    assert to_do.startswith("To do: put the equation into the simulation")
    assert rest == [
        "cogging: a ripple [A sin(n q)].",
        "load_coulomb: friction grows with the load. This recording cannot tell it from load_quadratic.",
        "Off in the simulation: inertia 0.42 kg·m², not 0.3.",
    ]


def test_what_the_opening_is_not_about_stands_behind_it() -> None:
    late = NamedEffect(name="velocity_filter_lag", kind="measurement", parameters={}, sentence="the velocity lags")
    what = _record(_RIPPLE, late).summary[0]
    assert what.endswith("recording shows: cogging. Found beside it: velocity_filter_lag.")
    what = _record(late, verdict="unknown_physics").summary[0]
    assert what == (
        "Something is missing that no effect of the catalogue explains. Found beside it: velocity_filter_lag."
    )


@pytest.mark.parametrize(("after", "advised"), [(0.5, True), (1.5, False)])
def test_nobody_is_told_to_compensate_with_a_model_that_is_worse_on_data_left_out(after: float, advised: bool) -> None:
    before, named, file = (
        ModelErrors(torque=TorqueError(rms, (0.9 * rms, 1.1 * rms), rms, 5.0, "N·m", 20.0, 30.0))
        for rms in (1.0, after, 0.4)
    )
    record = _record(_RIPPLE, errors=FileErrors(before=before, after=named, file=file, folds=4))
    (to_do,) = (line for line in record.summary if line.startswith("To do: "))
    assert ("compensate with friction.json" in to_do) == advised


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("external_disturbance", "find what acts on the joint at these times"),
        ("joint_elasticity", "friction.json has no term for it"),
    ],
)
def test_nobody_is_told_to_compensate_with_a_model_that_has_nothing_of_what_was_found(name: str, told: str) -> None:
    error = ModelErrors(torque=TorqueError(2.0, (1.9, 2.1), 1.8, 5.0, "N·m", 17.0, 30.0))
    found = NamedEffect(name=name, kind="physics", parameters={}, sentence="it acts")
    errors = FileErrors(before=error, after=None, file=error, folds=4, missing=(name,))
    to_do = next(line for line in _record(found, errors=errors).summary if line.startswith("To do: "))
    assert told in to_do
    assert "compensate" not in to_do


def test_what_needs_care_and_what_was_doubted_is_told_and_other_remarks_are_not() -> None:
    notes = Notes(
        facts=("backlash is not named: its interval holds zero.", "cogging is not named: it may be another."),
        remarks=("Rate: 10 rows repeat.", "Careful: it is late."),
    )
    record = _record(verdict="unknown_physics", notes=notes)
    assert record.summary[-2:] == ("Came up, but too unsure to be named: backlash, cogging.", "Careful: it is late.")
    assert not any("Rate" in one for one in record.summary)
    assert {"Rate: 10 rows repeat.", "Careful: it is late."} <= set(record.sentences)


def test_of_bad_data_every_reason_is_told_before_what_to_do() -> None:
    notes = Notes(facts=("column torque: its sign.",), remarks=("Clock: uneven.",))
    record = _record(verdict="bad_data", notes=notes)
    told = ("The data cannot be diagnosed.", "column torque: its sign.", "Clock: uneven.")
    assert record.summary[:3] == told
    assert record.summary[3].startswith("To do: mend what these sentences name")


@pytest.mark.parametrize(("columns", "lines"), [("100", 16), ("60", 25)])
def test_the_answer_of_two_effects_fits_a_small_terminal(
    columns: str, lines: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    diagnosis = Diagnosis(_record(_RIPPLE, _LOAD))
    print_diagnosis(DiagnosisRun(diagnosis, (Path("diagnosis.json"), Path("where.png")), ()), Path("runs/why"))
    said = capsys.readouterr().out
    assert len(said.splitlines()) <= lines
    assert "amplitude" in said
    assert "sine" not in said
    end = "Verdict: missing_physics. All figures, pictures and remarks: report.html. In runs/why: diagnosis.json\n"
    assert said.endswith(end)


def test_what_comes_closest_is_told_where_nothing_is_named_and_it_covers_more_than_it_leaves() -> None:
    stop, pair = (
        Rival(effects=names, gain=gain, coverage=coverage, refused=TOO_MUCH_LEFT)
        for names, gain, coverage in ((("end_stop",), 90.0, 0.4), (("end_stop", "cogging"), 100.0, 0.86))
    )
    impossible = Rival(effects=("supply_sag",), gain=200.0, coverage=0.9, refused="the torque would rise")

    def told(verdict: str, *rivals: Rival) -> list[str]:
        fields = DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict=verdict, rivals=rivals)  # type: ignore[arg-type]
        return [line for line in write_record(fields, _NONE).summary if "Closest" in line]

    assert told("unknown_physics", impossible, pair, stop) == [
        "Closest comes end_stop with cogging: it covers 86% of what lies above the noise, too little for a name."
    ]
    assert not told("unknown_physics", impossible, stop)
    assert not told("missing_physics", pair)


def test_where_nothing_is_named_nobody_is_told_that_it_is_no_better() -> None:
    given, refitted = (
        ModelErrors(torque=TorqueError(rms, (0.9 * rms, 1.1 * rms), rms, 5.0, "N·m", 35.0, 30.0))
        for rms in (0.12, 0.122)
    )
    record = _record(verdict="consistent", errors=FileErrors(before=given, after=refitted, file=refitted, folds=6))
    (to_do,) = (line for line in record.summary if line.startswith("To do: "))
    assert to_do.startswith("To do: take the friction from friction.json")
