"""Effects that a simulation has itself: left out, told with another size, or told as too much."""

from __future__ import annotations

from msgspec.structs import replace as with_fields

from fricomp.diagnosis.effects.shared_effect import remove_known
from fricomp.diagnosis.record.result import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord, NamedEffect, Quantity
from fricomp.diagnosis.record.sentence import NO_MOTION, sentences


def _cogging(sine: float, cosine: float, half: float = 0.01) -> NamedEffect:
    numbers = {"sine": sine, "cosine": cosine, "order": 12.0}
    return NamedEffect(
        name="cogging",
        kind="physics",
        parameters={name: Quantity(value, "N·m", (value - half, value + half)) for name, value in numbers.items()},
        sentence="a torque ripple",
    )


_DRAG = NamedEffect(
    name="quadratic_drag",
    kind="physics",
    parameters={"coefficient": Quantity(0.5, "N·m·s²/rad²", (0.4, 0.6))},
    indistinguishable_from=("power_law_viscous",),
    sentence="drag",
)


def _diagnosis(*effects: NamedEffect, verdict: str = "missing_physics") -> Diagnosis:
    record = DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict=verdict, effects=effects, sentences=())  # type: ignore[arg-type]
    return Diagnosis(with_fields(record, sentences=(*sentences(record), NO_MOTION, "last")))


def test_what_both_have_is_not_missing() -> None:
    found = remove_known(_diagnosis(_cogging(0.3, 0.0)), [_cogging(0.0, 0.3)])  # another encoder's phase
    assert found.verdict == "consistent"
    assert found.effects == ()
    assert found.sentences[0].endswith("the simulation shows as well.")
    assert found.sentences[-2:] == (
        "last",
        "The simulation shows cogging as well, so this is not missing in it.",
    )
    assert NO_MOTION not in found.sentences


def test_what_only_the_recording_has_stays_missing() -> None:
    found = remove_known(_diagnosis(_cogging(0.3, 0.0), _DRAG), [_cogging(0.3, 0.0)])
    assert found.verdict == "missing_physics"
    assert [effect.name for effect in found.effects] == ["quadratic_drag"]
    assert NO_MOTION in found.sentences


def test_another_size_is_a_parameter() -> None:
    found = remove_known(_diagnosis(_cogging(0.3, 0.0)), [_cogging(0.06, 0.08)])
    assert found.verdict == "parameters"
    (effect,) = found.effects
    assert effect.kind == "parameter"
    assert "the simulation has it with amplitude 0.1 N·m in place of 0.3" in effect.sentence
    close = remove_known(_diagnosis(_cogging(0.3, 0.0, 0.05)), [_cogging(0.25, 0.0, 0.05)])
    assert close.verdict == "consistent"


def test_two_names_that_a_recording_cannot_tell_apart_are_one_effect() -> None:
    other = NamedEffect(name="power_law_viscous", kind="physics", parameters={})
    assert remove_known(_diagnosis(_DRAG), [other]).verdict == "consistent"
    assert remove_known(_diagnosis(other), [_DRAG]).verdict == "consistent"


def test_what_only_the_simulation_has_is_told() -> None:
    found = remove_known(_diagnosis(verdict="consistent"), [_cogging(0.3, 0.0)])
    assert found.verdict == "parameters"
    assert found.effects == ()
    assert "(amplitude 0.3 N·m, order 12 N·m), which the recording does not" in found.sentences[-1]
    assert remove_known(_diagnosis(_DRAG), [_DRAG, _cogging(0.3, 0.0)]).verdict == "parameters"


def test_nothing_changes_where_the_simulation_shows_nothing_and_unknown_stays_unknown() -> None:
    plain = _diagnosis(_cogging(0.3, 0.0))
    assert remove_known(plain, []) is plain
    assert remove_known(_diagnosis(verdict="unknown_physics"), [_DRAG]).verdict == "unknown_physics"


def test_what_does_not_explain_the_simulation_says_nothing_by_its_size_or_its_lack() -> None:
    found = remove_known(_diagnosis(_cogging(0.3, 0.0)), [_cogging(0.1, 0.0), _DRAG], sure=False)
    assert found.verdict == "consistent"
    assert not any("too much" in line for line in found.sentences)
