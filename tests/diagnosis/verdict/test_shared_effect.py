"""Effects that a simulation has itself: left out, named with another size, or told as too much."""

from __future__ import annotations

from fricomp.diagnosis.record.result import NamedEffect, Quantity
from fricomp.diagnosis.verdict.judging import judge
from fricomp.diagnosis.verdict.shared_effect import SharedEffects, SimulationEffects, share_effects

from ..known import known_baseline, known_findings


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


def _share(named: tuple[NamedEffect, ...], *own: NamedEffect, sure: bool = True) -> SharedEffects:
    return share_effects(named, SimulationEffects(own, sure=sure, remarks=("last",)))


def test_what_both_have_is_not_missing() -> None:
    found = _share((_cogging(0.3, 0.0),), _cogging(0.0, 0.3))  # another encoder's phase
    assert found.effects == ()
    assert found.all_shared
    assert found.told == ("The simulation shows cogging as well, so this is not missing in it.", "last")


def test_what_only_the_recording_has_stays_missing() -> None:
    found = _share((_cogging(0.3, 0.0), _DRAG), _cogging(0.3, 0.0))
    assert found.effects == (_DRAG,)
    assert found.kinds == {"physics"}
    assert not found.all_shared


def test_another_size_is_a_parameter() -> None:
    found = _share((_cogging(0.3, 0.0),), _cogging(0.06, 0.08))
    (effect,) = found.effects
    assert effect.kind == "parameter"
    assert "the simulation has it with amplitude 0.1 N·m in place of 0.3" in effect.sentence
    assert _share((_cogging(0.3, 0.0, 0.05),), _cogging(0.25, 0.0, 0.05)).effects == ()


def test_two_names_that_a_recording_cannot_tell_apart_are_one_effect() -> None:
    other = NamedEffect(name="power_law_viscous", kind="physics", parameters={})
    assert _share((_DRAG,), other).effects == ()
    assert _share((other,), _DRAG).effects == ()


def test_what_only_the_simulation_has_is_told_and_a_wrong_parameter() -> None:
    found = _share((), _cogging(0.3, 0.0))
    assert found.kinds == {"parameter"}
    assert "(amplitude 0.3 N·m, order 12 N·m), which the recording does not" in found.told[0]
    assert not found.all_shared
    assert _share((_DRAG,), _DRAG, _cogging(0.3, 0.0)).kinds == {"parameter"}


def test_nothing_changes_where_the_simulation_shows_nothing_and_unknown_stays_unknown() -> None:
    plain = (_cogging(0.3, 0.0),)
    assert share_effects(plain, None) == SharedEffects(plain)
    assert _share(plain).effects == plain
    unknown = known_findings(known_baseline(), unknown=True)
    assert judge(unknown, simulated=SimulationEffects((_DRAG,))).word == "unknown_physics"


def test_what_does_not_explain_the_simulation_says_nothing_by_its_size_or_its_lack() -> None:
    found = _share((_cogging(0.3, 0.0),), _cogging(0.1, 0.0), _DRAG, sure=False)
    assert found.effects == ()
    assert found.kinds == set()
    assert not any("too much" in line for line in found.told)
