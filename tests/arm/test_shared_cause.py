"""What most joints show is told once, with their names; what one shows is its own. What a recording does not hold
is not told as sure."""

from __future__ import annotations

from fricomp.arm.record import JointEffect, JointRecord
from fricomp.arm.words.brief import list_few_worse, say_doubts, say_shared_causes
from fricomp.diagnosis.record.result import Quantity


def joint(name: str, *effects: str, level: float = 1.0, error: float = 0.4) -> JointRecord:
    found = tuple(
        JointEffect(name=one, parameters={}, recurrence=1.0, log_bayes_factor=9.0, fall=0.5, equation="")
        for one in effects
    )
    rotor = Quantity(0.1, "kg·m²", (0.0, 0.2))
    return JointRecord(
        name=name,
        unit="N·m",
        friction={"coulomb": Quantity(level, "N·m", (level, level + 0.1))},
        effects=found,
        rotor_inertia=rotor,
        error_simulation=1.0,
        error_plain=0.8,
        error_model=error,
    )


def test_what_half_of_the_joints_show_is_told_once() -> None:
    warm = [joint(name, "thermal_friction") for name in "abc"]
    (line,) = say_shared_causes([*warm, joint("d", "cogging"), joint("e"), joint("f")])
    assert line.startswith("thermal_friction shows in 3 of 6 joints (a, b, c).")
    assert "warms up as a whole" in line


def test_what_few_joints_show_is_their_own() -> None:
    assert say_shared_causes([joint("a", "cogging"), joint("b", "cogging"), joint("c")]) == ()
    assert say_shared_causes([*(joint(n, "cogging") for n in "abc"), *(joint(n) for n in "defg")]) == ()


def test_joints_that_do_not_rub_are_told_before_all_else() -> None:
    (line,) = say_doubts([joint("a", level=0.0), joint("b", level=0.0), joint("c")])
    assert line.startswith("The torques show no friction in a, b:")
    assert say_doubts([joint("a", level=0.0), joint("b"), joint("c")]) == ()
    assert say_doubts([joint(name, "presliding_hysteresis", level=0.0) for name in "abc"]) == ()


def test_a_joint_that_is_told_worse_than_by_its_simulation_is_in_doubt() -> None:
    (line,) = say_doubts([joint("a", error=1.5), joint("b")])
    assert "(a 1.5 N·m, by the simulation 1)" in line
    assert say_doubts([joint("a", error=1.1), joint("b")]) == ()


def test_one_joint_of_many_that_is_told_worse_is_in_doubt_alone() -> None:
    joints = [joint("a", error=1.5), joint("b"), joint("c")]
    (line,) = say_doubts(joints)
    assert line.startswith("What is told of a does not hold")
    assert [one.name for one in list_few_worse(joints)] == ["a"]
    assert list_few_worse([joint("a", error=1.5), joint("b", error=1.5), joint("c")]) == []
