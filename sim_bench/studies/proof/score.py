"""The score of one case: what was concealed against what was answered."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from ..kit.belief import Belief, list_beliefs
from ..kit.blind import BlindAnswer
from ..kit.interval import KnownInterval, compare_parameters
from ..kit.score import judge_names, list_sets, read_diagnosis
from .making import write_command
from .plan import PlannedCase

SIMULATION = "simulation"
"""What stands for an effect where inertia and gravity of a shifted simulation are compared."""

_OF_THE_RUN = ("group", "proposed", "recorded", "seconds", "error", "command")
"""Fields of a score that follow from the run and not from answer and diagnosis."""

_GRID = 1e-3
"""Step at which two sets of time intervals are compared [s]: the period of the recordings."""


@dataclass(frozen=True)
class Score:
    """One row of the results.

    Attributes:
        case: Name of the case.
        group: Of the plan.
        seed: Of the case.
        excitation: Its motion.
        duration: [s]
        noise: Kind of torque noise.
        core: Friction core.
        strength: As asked for.
        enr: Effect-to-noise ratio after the base refit, all effects together.
        weakest_enr: The smallest that one of its effects has beside the others.
        rows: Number of weak-form rows behind it.
        truth: Concealed effects, joined by a plus sign; empty for none.
        forms: Their functional forms.
        expected: Verdict of a right answer.
        verdict: The verdict given; `failed` where there is none.
        named: What was named, strongest first, joined by a plus sign.
        sets: For each name, what it cannot be told from, joined by a bar.
        top_right: The strongest name is a concealed effect, or was accepted for it.
        exact: The named effects are the concealed ones, no more and no less; inertia and gravity that are off aside.
        in_set: Every concealed effect is named or in the set of a name.
        set_size: Mean number of names in a set; 0 where nothing was named.
        printed: Sets of two names or more.
        printed_right: How many of them hold a concealed effect, or what is accepted for one.
        false_names: Names that are neither concealed, nor accepted, nor come with a concealed one in their set; those
            of parameters count where the simulation has them right.
        false_parameters: How many of them are names of parameters.
        verdict_right: The verdict is the expected one, or was accepted for it.
        overlap: Intersection over union of the located and the true time, 0 where no time was named; NaN where the
            effect is not localised.
        noise_ratio: Residual of the base model over its noise floor, as the diagnosis sees it; NaN where not given.
        intervals: Of parameters whose truth is known.
        proposed: It proposed a motion to tell a printed set apart.
        recorded: That motion could be recorded, and both recordings were diagnosed together.
        resolved: With it, of every printed set nothing but the truth is left.
        seconds: Time of the diagnosis [s].
        error: Why it failed; empty where it did not.
        command: Makes the case again.
        beliefs: Probabilities of the answer, beside what is true.
    """

    case: str
    group: str
    seed: str
    excitation: str
    duration: float
    noise: str
    core: str
    strength: str
    enr: float
    weakest_enr: float
    rows: int
    truth: str
    forms: str
    expected: str
    verdict: str
    named: str
    sets: str
    top_right: bool
    exact: bool
    in_set: bool
    set_size: float
    printed: int
    printed_right: int
    false_names: int
    false_parameters: int
    verdict_right: bool
    overlap: float
    noise_ratio: float
    intervals: tuple[KnownInterval, ...]
    proposed: bool
    recorded: bool
    resolved: bool
    seconds: float
    error: str
    command: str
    beliefs: tuple[Belief, ...] = ()


def read_score(row: Mapping[str, Any]) -> Score:
    """A score from a row of a store or of a table."""
    return msgspec.convert(dict(row), Score)


def score_case(planned: PlannedCase, answer: bytes, blind: BlindAnswer, follow_up: BlindAnswer | None = None) -> Score:
    """Compare an opened answer with what the diagnosis said, and with what it said after the proposed motion."""
    known = {
        "group": planned.group,
        "proposed": asks_for_more(blind),
        "recorded": follow_up is not None,
        "seconds": blind.seconds,
        "error": blind.error,
        "command": write_command(planned.spec),
    }
    return score_again(known, answer, blind.diagnosis, follow_up.diagnosis if follow_up else b"")


def score_again(known: Mapping[str, Any], answer: bytes, diagnosis: bytes, follow_up: bytes = b"") -> Score:
    """A score by the rules of today.

    Args:
        known: Fields of the score that the run alone knows: group, time, command, and whether a motion was proposed
            and recorded. Others do not count.
        answer: As it was opened.
        diagnosis: What was said of it; empty for nothing.
        follow_up: What was said with the proposed motion; empty for nothing.
    """
    truth, said = json.loads(answer), read_diagnosis(diagnosis)
    return Score(
        **{name: known[name] for name in _OF_THE_RUN},
        **_compare(truth, said),
        resolved=bool(follow_up) and _tells_apart(truth, said, read_diagnosis(follow_up)),
    )


def _compare(truth: dict[str, Any], said: dict[str, Any]) -> dict[str, Any]:
    """All of a score that follows from the answer and the diagnosis."""
    effects, joint, spec = truth["effects"], truth["joint"], truth["spec"]
    return {
        "case": truth["id"],
        "seed": str(spec["seed"]),
        "excitation": spec["excitation"],
        "duration": spec["duration"],
        "noise": joint["noise_kind"],
        "core": joint["core"],
        "strength": spec["strength"] if effects else "",
        "enr": truth["enr"],
        "weakest_enr": min((each["separable_enr"] for each in effects), default=0.0),
        "rows": truth["rows"],
        "truth": "+".join(each["name"] for each in effects),
        "forms": "+".join(each["form"] for each in effects),
        "expected": truth["verdict"],
        "verdict": said["verdict"],
        "named": "+".join(each["name"] for each in said["effects"]),
        "sets": "+".join("|".join(each.get("indistinguishable_from", ())) for each in said["effects"]),
        **_score_names(truth, said),
        "verdict_right": _is_verdict_right(truth, said),
        "overlap": _score_location(truth, said, spec["duration"]),
        "noise_ratio": _read_number(said.get("noise_ratio")),
        "intervals": compare_intervals(truth, said),
        "beliefs": list_beliefs(said, _list_tolerated(truth).union(*_list_right_names(truth)), truth["verdict"]),
    }


def _list_right_names(truth: dict[str, Any]) -> list[set[str]]:
    """For each concealed effect of the catalogue the names that are right for it."""
    return [{each["name"], *each["accepted"]} for each in truth["effects"] if each["kind"] != "outside"]


def _list_tolerated(truth: dict[str, Any]) -> set[str]:
    """Names that are never wrong in this case: inertia and gravity that are off, and what an outside effect may be."""
    outside = {name for each in truth["effects"] if each["kind"] == "outside" for name in each["accepted"]}
    return {*truth["shifted_parameters"], *outside}


def _score_names(truth: dict[str, Any], said: dict[str, Any]) -> dict[str, Any]:
    right, tolerated = _list_right_names(truth), _list_tolerated(truth)
    wanted: set[str] = set().union(*right) if right else set()
    sets = list_sets(said)
    judged = judge_names(sets, wanted, tolerated)
    found = [not names.isdisjoint(judged.sets) for names in right]
    printed = [group for group in sets.values() if len(group) > 1]
    return {
        "top_right": judged.first_is_right,
        "exact": all(found) and wanted.issuperset(judged.sets) and len(judged.sets) <= len(right),
        "in_set": bool(right) and all(any(names & group for group in sets.values()) for names in right),
        "set_size": float(np.mean([len(group) for group in sets.values()])) if sets else 0.0,
        "printed": len(printed),
        "printed_right": sum(bool(group & (wanted | tolerated)) for group in printed),
        "false_names": len(judged.false_names),
        "false_parameters": len(judged.false_parameters),
    }


def asks_for_more(answer: BlindAnswer) -> bool:
    """Whether a diagnosis printed a set and proposed a motion to tell it apart."""
    said = read_diagnosis(answer.diagnosis)
    return bool(answer.motion) and any(each.get("indistinguishable_from") for each in said["effects"])


def _tells_apart(truth: dict[str, Any], first: dict[str, Any], second: dict[str, Any]) -> bool:
    """Whether of every set that was printed first, something is left, and that is true."""
    right = {*_list_tolerated(truth), *set().union(*_list_right_names(truth))}
    left = set().union(*list_sets(second).values())
    return all(group & left and group & left <= right for group in list_sets(first).values() if len(group) > 1)


def _is_verdict_right(truth: dict[str, Any], said: dict[str, Any]) -> bool:
    accepted = {name for each in truth["effects"] for name in each["accepted"]}
    names = {each["name"] for each in said["effects"]}
    return bool(said["verdict"] == truth["verdict"] or said["verdict"] in accepted or names & accepted)


def compute_overlap(first: Sequence[Sequence[float]], second: Sequence[Sequence[float]], duration: float) -> float:
    """Intersection over union of two sets of time intervals [s] within 0 and `duration`; 0 for two empty sets."""
    time = np.arange(0.0, duration, _GRID)
    masks = []
    for intervals in (first, second):
        mask = np.zeros(time.size, dtype=bool)
        for start, end in intervals:
            mask |= (time >= start) & (time < end)
        masks.append(mask)
    union = np.sum(masks[0] | masks[1])
    return float(np.sum(masks[0] & masks[1]) / union) if union else 0.0


def _score_location(truth: dict[str, Any], said: dict[str, Any], duration: float) -> float:
    localised = bool(truth["effects"]) and all(each["localised"] for each in truth["effects"])
    if not localised:
        return float("nan")
    location = said.get("location") or {}
    return compute_overlap(truth["location"]["time"], location.get("time", []), duration)


def _read_number(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def compare_intervals(truth: Mapping[str, Any], said: Mapping[str, Any]) -> tuple[KnownInterval, ...]:
    """All parameters that can be compared, of concealed effects that were named.

    Inertia and gravity count besides, where those of the simulation were shifted and found to be.

    Args:
        truth: The opened answer.
        said: The diagnosis.
    """
    given = {each["name"]: each["parameters"] for each in said["effects"]}
    pairs = {each["name"]: (given.get(each["name"], {}), _read_values(each["comparable"])) for each in truth["effects"]}
    if "gravity" in truth["joint"] and given.keys() & set(truth["shifted_parameters"]):
        pairs[SIMULATION] = (_read_refitted(said), _read_body(truth["joint"]))
    return tuple(
        each
        for effect, (found, wanted) in pairs.items()
        if _count_numbered(found) == _count_numbered(wanted)  # where a push is missed, nobody knows which is the second
        for each in compare_parameters(effect, found, wanted)
    )


def _read_values(parameters: Mapping[str, Any]) -> dict[str, float]:
    return {name: each["value"] for name, each in parameters.items()}


def _read_refitted(said: Mapping[str, Any]) -> dict[str, Any]:
    """What a diagnosis says has changed in the simulation, with its interval."""
    return {each["name"]: each["refitted"] for each in said.get("changes") or () if each.get("refitted")}


def _read_body(joint: Mapping[str, Any]) -> dict[str, float]:
    """Inertia and gravity of the concealed joint by the names of a diagnosis."""
    gravity, angle = joint["gravity"], joint["gravity_angle"]
    return {
        "inertia": joint["inertia"],
        "gravity_cos": gravity * float(np.sin(angle)),
        "gravity_sin": gravity * float(np.cos(angle)),
    }


def _count_numbered(parameters: Mapping[str, Any]) -> int:
    """How many of the same thing an effect has, such as pushes."""
    return sum(name.startswith("start_") for name in parameters)
