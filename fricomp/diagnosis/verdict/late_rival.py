"""Two answers to one case, one with the torque moved to where it may act: which of them is kept."""

from __future__ import annotations

from dataclasses import replace

import msgspec

from ..effects import EFFECTS
from ..evidence.findings import Findings
from .judging import Verdict, join_channels
from .naming import name_late_action
from .settings import LATE

Answer = tuple[Findings, Verdict]


def choose_late(moved: Answer, before: Answer, usual: float, *, shows: bool) -> Answer:
    """Keep the answer with the torque moved where it leaves less, or says with fewer names as much.

    Args:
        moved: With the torque where it may act.
        before: With the torque at its stamps.
        usual: How late a torque without any flaw is at most [s].
        shows: Whether the recording itself tells that the torque is late, and not an effect in the answer before.
    """
    late = name_late_action(moved[0])
    is_late = late.parameters["delay"].ci95[0] > usual
    if _leaves_less(moved[1], before[1], is_late) if shows else _completes(moved, before, is_late):
        return moved[0], join_channels(moved[1], [late]) if is_late else moved[1]
    if is_late and not shows and _is_alike(moved, before):
        return before[0], _tell_alike(before[1])
    return before


def leaves_noise_alone(verdict: Verdict) -> bool:
    """Whether the error of what was found cannot fall clearly any more: a model with nothing missing would leave it."""
    return verdict.held.noise_floor > (1.0 - LATE.fall) * verdict.held.rmse_after


def _leaves_less(moved: Verdict, before: Verdict, is_late: bool) -> bool:
    """Whether the error falls, and by no more names than left noise alone before: such as a lag in place of a delay.
    What is far below that noise shows that it was none. Where something stays unknown, most of the error has to go."""
    if moved.word == "unknown_physics":
        return moved.held.rmse_after < (1.0 - LATE.explains) * before.held.rmse_after
    far_less = moved.held.rmse_after < LATE.explains * before.held.noise_floor
    wordier = len(moved.effects) + is_late > len(before.effects) and leaves_noise_alone(before) and not far_less
    return moved.held.rmse_after <= before.held.rmse_after and not wordier


def _completes(late: Answer, answer: Answer, is_late: bool) -> bool:
    """Whether the error falls clearly, and a late torque needs no names but those that were there without it and the
    form of the friction, which a lag in place of a delay bends; others may come where none is late, and the rows left
    something unknown, or where less is left than had passed for noise. Or whether it says with fewer names as much, or
    better by a delay what a lag had said."""
    (_, moved), (findings, before) = late, answer
    instead = is_late and _takes_its_place(moved, before)
    if instead or leaves_noise_alone(before):
        return instead and _compare_plain(late, answer) < 1.0
    names, known = _list_names(moved), {effect.name for effect in before.effects}
    leaves = moved.word == "unknown_physics"
    says_it_shorter = is_late and not leaves and len(moved.effects) + 1 < len(before.effects)
    if says_it_shorter and moved.held.rmse_after < (1.0 + LATE.alike) * before.held.rmse_after:
        return True
    was_no_noise = moved.held.rmse_after < before.held.noise_floor  # by which the names before were weighed
    allowed = names <= known or (not leaves and (was_no_noise or (findings.unknown and not is_late)))
    least = LATE.explains if leaves else LATE.fall
    return allowed and moved.held.rmse_after < (1.0 - least) * before.held.rmse_after


def _is_alike(late: Answer, answer: Answer) -> bool:
    """Whether a delay says about as well what a lag says."""
    return _takes_its_place(late[1], answer[1]) and _compare_plain(late, answer) < 1.0 + LATE.alike


def _takes_its_place(moved: Verdict, before: Verdict) -> bool:
    """Whether the names are those that were there before, but for a lag of the drive."""
    known = {effect.name for effect in before.effects}
    return moved.word != "unknown_physics" and "drive_lag" in known and _list_names(moved) == known - {"drive_lag"}


def _list_names(verdict: Verdict) -> set[str]:
    """What is named, without the form of the friction."""
    forms = {name for name, effect in EFFECTS.items() if effect.form_of_friction}
    return {effect.name for effect in verdict.effects} - forms


def _compare_plain(late: Answer, answer: Answer) -> float:
    """Held-out error of rows without weights over that of the other answer: each has weights by nulls of its own."""
    return late[0].held.plain.after / max(answer[0].held.plain.after, 1e-30)


def _tell_alike(verdict: Verdict) -> Verdict:
    """The same with a delay beside the lag of the drive, as what this recording cannot tell from it."""
    effects = (
        msgspec.structs.replace(one, indistinguishable_from=(*one.indistinguishable_from, "torque_delay"))
        if one.name == "drive_lag" and "torque_delay" not in one.indistinguishable_from
        else one
        for one in verdict.effects
    )
    return replace(verdict, effects=tuple(effects))
