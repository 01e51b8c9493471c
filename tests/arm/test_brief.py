"""The short answer on an arm: what is wrong and what to do first, an effect of several joints told once."""

from __future__ import annotations

from msgspec.structs import replace

from fricomp.arm.record import ARM_SCHEMA, ArmRecord, JointEffect, JointFrame, JointRecord, LinkRecord, LinkState
from fricomp.arm.words.brief import (
    say_offsets,
    say_unexplained,
    say_unnamed,
    write_summary,
)
from fricomp.arm.words.links import name_link
from fricomp.arm.words.opening import say_links, say_nothing_missing, write_opening, write_title
from fricomp.arm.words.quantity import show_quantity
from fricomp.diagnosis.record.result import Quantity


def _joint(name: str, level: float | None) -> JointRecord:
    effect = JointEffect(
        name="load_coulomb",
        parameters={"coefficient": Quantity(level or 0.0, "1", (0.0, 1.0))},
        recurrence=1.0,
        log_bayes_factor=9.0,
        fall=0.5,
        equation="c |tau|",
        indistinguishable_from=("load_quadratic",) if name == "b" else (),
    )
    rotor = Quantity(0.1, "kg·m²", (0.0, 0.2))
    return JointRecord(
        name=name,
        unit="N·m",
        friction={},
        effects=() if level is None else (effect,),
        rotor_inertia=rotor,
        error_simulation=1.0,
        error_plain=0.8,
        error_model=0.4,
    )


def _link(name: str, mass: float, state: LinkState) -> LinkRecord:
    found = Quantity(mass, "kg", (mass - 0.2, mass + 0.2))
    moment = {"x": Quantity(0.05, "kg·m", (0.04, 0.06)), "y": Quantity(0.3, "kg·m", (-1.0, 1.0))}
    return LinkRecord(
        name=name, simulated_mass=2.0, mass=found, first_moment=moment, state=state, determined=("x",),
        simulated_first_moment={"x": 0.03, "y": 0.0},
    )  # fmt: skip


def _record(joints: tuple[JointRecord, ...], links: tuple[LinkRecord, ...] = ()) -> ArmRecord:
    late = Quantity(0.0, "s", (0.0, 0.0))
    return ArmRecord(
        schema=ARM_SCHEMA, sentences=(), joints=joints, links=links, delay=late, gain=None, cutoff=20.0, duration=60.0,
        left_out=0.0,
    )  # fmt: skip


def test_a_centre_that_is_far_off_is_told_in_millimetres() -> None:
    link = _link("hand", 2.1, "off")
    far = replace(link, first_moment=link.first_moment | {"x": Quantity(0.278, "kg·m", (0.25, 0.3))})
    assert name_link(far) == "hand (mass elsewhere, as if its centre were off by 120 mm)"


def test_what_to_do_comes_second_and_an_effect_of_two_joints_is_told_once() -> None:
    links = (_link("upper", 4.0, "off"), _link("hand", 2.1, "off"), _link("base", 2.0, "not_determined"))
    told = write_summary(
        _record((_joint("a", 0.1), _joint("b", 0.2), *(_joint(name, None) for name in "cdefg")), links), "Off."
    )
    assert told[0] == "Off."
    assert told[1].startswith("To do: simulate with arm.xml")
    effect, off, unknown = told[2:]
    assert effect.endswith("[c |tau|]; a coefficient 0.1; b (or load_quadratic) coefficient 0.2.")
    assert off == "Links that are off: upper (+2 kg), hand (mass elsewhere, as if its centre were off by 10 mm)."
    assert unknown == "Not shown by this motion: the mass of base."


def test_of_an_arm_that_is_as_simulated_there_is_nothing_to_do() -> None:
    told = write_summary(_record((_joint("a", None),), (_link("upper", 2.0, "as_simulated"),)), "Nothing is missing.")
    assert told[0] == "Nothing is missing."
    assert told[1].startswith("To do: nothing")
    assert len(told) == 2


def test_where_joints_do_not_rub_there_is_another_recording_to_do() -> None:
    loose = {"coulomb": Quantity(0.0, "N·m", (0.0, 0.1))}
    joints = tuple(replace(_joint(name, None), friction=loose) for name in "ab")
    told = write_summary(_record(joints), "Nothing is missing.")
    assert told[1].startswith("The torques show no friction in a, b:")
    assert told[2].startswith("To do: record again")


def test_a_joint_in_another_unit_or_frame_is_told_before_all_else() -> None:
    frame = JointFrame(joint="b", direction=-1, offset=1.5)
    record = replace(_record((_joint("a", None),)), torque_scales={"a": 0.01}, better_frames=(frame,))
    told = write_summary(record, "Off.")
    assert "a 0.01 times" in told[1]
    assert "b, with position -q +1.5 rad and torque the other way" in told[2]
    for other in (record, replace(record, better_frames=()), replace(record, torque_scales={})):
        (to_do,) = (one for one in write_summary(other, "Off.") if one.startswith("To do"))
        assert to_do.startswith("To do: give these joints one zero, direction and unit")


def test_frames_that_would_do_in_place_of_another_mounting_speak_against_nothing() -> None:
    frame = JointFrame(joint="b", direction=1, offset=3.0)
    record = replace(_record((_joint("a", None),)), gravity=(0.0, 0.0, 9.81), frames_instead=(frame,))
    told = write_summary(record, "Nothing is missing.")
    assert any("the same with b" in line for line in told)
    assert not any(line.startswith("To do: give these joints") for line in told)


def test_what_nothing_explains_is_told_before_anything_is_said_to_be_well() -> None:
    joints = (replace(_joint("a", None), unexplained=0.3), replace(_joint("b", 0.1), unexplained=0.5))
    record = replace(_record(joints), held_joints=("wrist",))
    (told,) = say_unexplained(record)
    assert "in a (30% of its friction): such as joints that moved and were not recorded (wrist)" in told
    assert write_summary(record, told)[1].startswith("To do: look for what else moves")
    assert say_unexplained(_record((_joint("a", None), replace(_joint("b", None), unexplained=0.05)))) == ()
    assert say_unexplained(replace(record, better_frames=(JointFrame(joint="a", direction=-1, offset=0.0),))) == ()


def test_the_title_says_no_more_than_the_answer() -> None:
    """A page that began with torque that nothing explains was called 'no physics is missing'."""
    fine, left = _joint("a", None), replace(_joint("b", None), unexplained=0.5)
    off = (_link("upper", 4.0, "off"),)
    friction = {"coulomb": Quantity(1.0, "N·m", (0.9, 1.1))}
    fine, left = (replace(one, friction=friction) for one in (fine, left))
    assert write_title(_record((fine, fine))).endswith("2 joints: no physics is missing")
    assert write_title(_record((fine, fine), off)).endswith("only links are off")
    assert write_title(_record((fine, left), off)).endswith("unexplained torque in b")
    assert write_title(_record((_joint("c", 0.1), left))).endswith("physics is missing")
    frames = (JointFrame(joint="a", direction=-1, offset=0.0),)
    assert write_title(replace(_record((fine, left)), better_frames=frames)).endswith("in doubt")


def test_links_that_are_off_by_little_are_told_to_be() -> None:
    little, much = (replace(_joint(name, None), link_change=part) for name, part in (("a", 0.002), ("b", 0.03)))
    assert say_links((little, much)).startswith("Only links are off, by 3% of the torque of b at most")
    assert "by less than 1% of the torque of a" in say_links((little,))
    assert say_nothing_missing((little, much)).endswith("as simulated but for 3% of the torque of b.")


def test_what_a_model_holds_without_a_name_is_told_with_how_little_it_is() -> None:
    plain, bent = _joint("a", None), replace(_joint("b", None), unnamed={"quadratic_drag": 0.06})
    assert say_unnamed((plain,)) == ()
    assert "b quadratic_drag (6%)" in say_unnamed((plain, bent))[0]
    assert "physics is missing in any" not in say_links((plain, bent))
    assert "Nothing is missing" not in say_nothing_missing((plain, bent))
    assert write_title(_record((plain, bent))).endswith("nothing is named")
    assert any("quadratic_drag" in line for line in write_summary(_record((plain, bent)), "Nothing is named."))


def test_a_narrow_interval_is_told_in_as_many_digits_as_tell_its_ends_apart() -> None:
    assert show_quantity(Quantity(0.01921, "kg·m", (0.01919, 0.01923))) == "0.01921 kg·m (0.01919 to 0.01923)"
    assert show_quantity(Quantity(0.439, "kg·m", (0.384, 0.493))) == "0.439 kg·m (0.384 to 0.493)"
    assert show_quantity(Quantity(2.0, "s", (2.0, 2.0))) == "2 s (2 to 2)"
    assert show_quantity(Quantity(-1.0 / 3.0, "1", (-1.0 / 3.0 - 1e-12, -1.0 / 3.0))).startswith("-0.333333 (")


def test_a_constant_torque_is_told_where_it_is_surely_a_part_of_the_friction() -> None:
    def joint(name: str, offset: tuple[float, float]) -> JointRecord:
        friction = {"coulomb": Quantity(2.0, "N·m", (1.9, 2.1)), "offset": Quantity(sum(offset) / 2.0, "N·m", offset)}
        return replace(_joint(name, None), friction=friction)

    little, open_ended, sure = joint("a", (0.1, 0.3)), joint("b", (-0.5, 2.0)), joint("c", (-0.9, -0.7))
    assert say_offsets((little, open_ended)) == ()
    (line,) = say_offsets((little, open_ended, sure))
    assert "c -0.8 N·m (-0.9 to -0.7)" in line
    assert line in write_summary(_record((sure,)), "Nothing is named.")


def test_a_constant_torque_beside_a_spring_is_where_that_rests() -> None:
    friction = {"coulomb": Quantity(2.0, "N·m", (1.9, 2.1)), "offset": Quantity(4.0, "N·m", (3.9, 4.1))}
    joint = replace(_joint("a", 0.1), friction=friction)
    assert say_offsets((joint,)) != ()
    (effect,) = joint.effects
    assert say_offsets((replace(joint, effects=(replace(effect, name="spring_torque"),)),)) == ()


def test_friction_that_is_stated_wrong_is_no_arm_in_which_nothing_is_missing() -> None:
    """A simulation with half of the friction of a joint was told to lack nothing, and nothing was to be done."""
    wrong = replace(
        _joint("b", None),
        friction={"coulomb": Quantity(4.0, "N·m", (3.998, 4.002))},
        stated={"coulomb": 2.0},
    )
    for links, also in (((), ""), ((_link("upper", 4.0, "off"),), "and links by")):
        record = _record((_joint("a", None), wrong), links)
        opening = write_opening(record)
        assert opening.startswith("Only numbers of the simulation are off: friction or rotors that it states of b")
        assert also in opening
        assert "no physics is missing" in opening
        assert write_title(record).endswith("only numbers of the simulation are off")
        told = write_summary(record, opening)
        assert told[1].startswith("To do: simulate with arm.xml")
        assert any("b Coulomb friction 4 N·m (3.998 to 4.002) for 2." in line for line in told)


def test_a_delay_is_told_in_short_where_rows_that_hold_do_not_explain_it() -> None:
    def tell(delay: float) -> list[str]:
        late = Quantity(delay, "s", (delay - 1e-4, delay + 1e-4))
        record = replace(_record((_joint("a", None),)), delay=late, period=0.005)
        return [line for line in write_summary(record, "Fine.") if "All torques" in line]

    (late,), (early,) = tell(0.004), tell(-0.004)
    assert late.startswith("All torques are 4 ms late behind the positions")
    assert early.startswith("All torques are 4 ms ahead of the positions")
    assert tell(-0.0024) == tell(0.002) == []


def test_joints_of_which_nothing_is_said_are_told_in_short() -> None:
    told = write_summary(replace(_record((_joint("a", None),)), still_joints=("wrist",)), "Fine.")
    assert any("Stood still, so that nothing is said of them: wrist" in line for line in told)


def test_a_joint_whose_links_ask_for_another_time_is_told_before_what_is_named_in_it() -> None:
    early = replace(_joint("a", 0.1), link_delay=Quantity(-0.011, "s", (-0.012, -0.01)))
    told = write_summary(_record((early, _joint("b", None))), "Off.")
    (at,) = (k for k, line in enumerate(told) if "a 11 ms earlier (-12 to -10)" in line)
    assert at < next(k for k, line in enumerate(told) if line.startswith("load_coulomb"))
    assert not any("at another time" in line for line in write_summary(_record((_joint("a", 0.1),)), "Off."))


def test_torques_that_are_recorded_wrong_are_no_physics_that_is_missing() -> None:
    joint = _joint("a", 0.1)
    (effect,) = joint.effects
    scaled = replace(joint, effects=(replace(effect, name="torque_gain_error"),))
    record = _record((scaled, _joint("b", None)))
    assert write_opening(record).startswith("Torques are recorded wrong, and no physics is named: a (")
    assert write_title(record).endswith("torques are recorded wrong")
    both = _record((scaled, _joint("b", 0.1)))
    assert write_opening(both).startswith(
        "The simulation leaves out physics in a (torque_gain_error), b (load_coulomb)"
    )
    assert write_title(both).endswith("physics is missing")


def test_a_joint_that_sticks_takes_the_advice_from_none_of_the_others() -> None:
    joints = (_joint("a", 0.1), *(_joint(name, None) for name in "bcd"))
    stuck = replace(joints[3], error_model=3.0 * joints[3].error_simulation + 10.0)
    told = write_summary(_record((*joints[:3], stuck)), "Off.")
    (to_do,) = (line for line in told if line.startswith("To do:"))
    assert to_do.startswith("To do: simulate with arm.xml")
    assert to_do.endswith("Record d again with more motion before you use what is told of it.")
