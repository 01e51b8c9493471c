"""What most joints show is told once, with their names; what one shows is its own."""

from __future__ import annotations

from fricomp.arm.brief import say_shared_causes
from fricomp.arm.record import JointEffect, JointRecord
from fricomp.diagnosis.record.result import Quantity


def joint(name: str, *effects: str) -> JointRecord:
    found = tuple(
        JointEffect(name=one, parameters={}, recurrence=1.0, log_bayes_factor=9.0, fall=0.5, equation="")
        for one in effects
    )
    rotor = Quantity(0.1, "kg·m²", (0.0, 0.2))
    return JointRecord(
        name=name,
        unit="N·m",
        friction={},
        effects=found,
        rotor_inertia=rotor,
        error_simulation=1.0,
        error_plain=0.8,
        error_model=0.4,
    )


def test_what_half_of_the_joints_show_is_told_once() -> None:
    warm = [joint(name, "thermal_friction") for name in "abc"]
    (line,) = say_shared_causes([*warm, joint("d", "cogging"), joint("e"), joint("f")])
    assert line.startswith("thermal_friction shows in 3 of 6 joints (a, b, c).")
    assert "warms up as a whole" in line


def test_what_few_joints_show_is_their_own() -> None:
    assert say_shared_causes([joint("a", "cogging"), joint("b", "cogging"), joint("c")]) == ()
    assert say_shared_causes([*(joint(n, "cogging") for n in "abc"), *(joint(n) for n in "defg")]) == ()
