"""The score of one case: what was concealed against what was answered."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricomp.errors import DiagnosisError

from .blind import BlindAnswer
from .intervals import KnownInterval, compare_intervals
from .making import command_of
from .plan import PlannedCase

__all__ = [
    "PARAMETERS",
    "Score",
    "asks_for_more",
    "brief_diagnosis",
    "interval_overlap",
    "read_diagnosis",
    "score_again",
    "score_case",
]

PARAMETERS = frozenset({"inertia_error", "payload_error", "torque_offset", "direction_asymmetry"})
"""Names of parameters that the simulation has, as against physics that it lacks."""

_SCORED = ("schema", "verdict", "effects", "heldout", "location", "noise_ratio", "changes")  # of a diagnosis
_TOLD = ("sentences",)  # beside it, what a reader looks for
_OF_THE_RUN = ("group", "proposed", "recorded", "seconds", "error", "command")
_GRID = 1e-3  # [s] of the comparison of two sets of intervals


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


def read_diagnosis(content: bytes) -> dict[str, Any]:
    """The content of `diagnosis.json`; an empty one reads as a failed diagnosis.

    Raises:
        DiagnosisError: It is of another schema.
    """
    if not content:
        return {"verdict": "failed", "effects": []}
    record: dict[str, Any] = json.loads(content)
    if record.get("schema") != "fricomp.diagnosis/1":
        raise DiagnosisError(f"a diagnosis has schema {record.get('schema')!r}, fricomp.diagnosis/1 can be scored")
    return record


def brief_diagnosis(content: bytes) -> bytes:
    """What a score reads of `diagnosis.json`, and the sentences: a tenth of it."""
    if not content:
        return b""
    record = json.loads(content)
    brief = {name: record[name] for name in (*_SCORED, *_TOLD) if name in record}
    brief["effects"] = [{k: v for k, v in each.items() if k != "location"} for each in record["effects"]]
    brief["location"] = {"time": (record.get("location") or {}).get("time", [])}
    return json.dumps(brief, ensure_ascii=False).encode()


def score_case(planned: PlannedCase, answer: bytes, blind: BlindAnswer, follow_up: BlindAnswer | None = None) -> Score:
    """Compare an opened answer with what the diagnosis said, and with what it said after the proposed motion."""
    known = {
        "group": planned.group,
        "proposed": asks_for_more(blind),
        "recorded": follow_up is not None,
        "seconds": blind.seconds,
        "error": blind.error,
        "command": command_of(planned.spec),
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
        resolved=bool(follow_up) and _resolved(truth, said, read_diagnosis(follow_up)),
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
        "verdict_right": _verdict_right(truth, said),
        "overlap": _score_location(truth, said, spec["duration"]),
        "noise_ratio": _number(said.get("noise_ratio")),
        "intervals": compare_intervals(truth, said),
    }


def _right_names(truth: dict[str, Any]) -> list[set[str]]:
    """For each concealed effect of the catalogue the names that are right for it."""
    return [{each["name"], *each["accepted"]} for each in truth["effects"] if each["kind"] != "outside"]


def _tolerated(truth: dict[str, Any]) -> set[str]:
    """Names that are never wrong in this case: inertia and gravity that are off, and what an outside effect may be."""
    outside = {name for each in truth["effects"] if each["kind"] == "outside" for name in each["accepted"]}
    return {*truth["shifted_parameters"], *outside}


def _score_names(truth: dict[str, Any], said: dict[str, Any]) -> dict[str, Any]:
    right, tolerated = _right_names(truth), _tolerated(truth)
    wanted: set[str] = set().union(*right) if right else set()
    named = [each["name"] for each in said["effects"]]
    sets = _sets(said)
    judged = [name for name in named if name in wanted or name not in tolerated]
    false = [name for name, group in zip(named, sets, strict=True) if name in judged and not group & wanted]
    found = [any(name in judged for name in names) for names in right]
    printed = [group for group in sets if len(group) > 1]
    return {
        "top_right": bool(judged) and judged[0] in wanted,
        "exact": all(found) and set(judged) <= wanted and len(judged) <= len(right),
        "in_set": bool(right) and all(any(names & group for group in sets) for names in right),
        "set_size": float(np.mean([len(group) for group in sets])) if sets else 0.0,
        "printed": len(printed),
        "printed_right": sum(bool(group & (wanted | tolerated)) for group in printed),
        "false_names": len(false),
        "false_parameters": len(PARAMETERS.intersection(false)),
    }


def asks_for_more(answer: BlindAnswer) -> bool:
    """Whether a diagnosis printed a set and proposed a motion to tell it apart."""
    said = read_diagnosis(answer.diagnosis)
    return bool(answer.motion) and any(each.get("indistinguishable_from") for each in said["effects"])


def _resolved(truth: dict[str, Any], first: dict[str, Any], second: dict[str, Any]) -> bool:
    """Whether of every set that was printed first, something is left, and that is true."""
    right = {*_tolerated(truth), *set().union(*_right_names(truth))}
    left = set().union(*_sets(second))
    return all(group & left and group & left <= right for group in _sets(first) if len(group) > 1)


def _sets(said: dict[str, Any]) -> list[set[str]]:
    """Each name with what it cannot be told from."""
    return [{each["name"], *each.get("indistinguishable_from", ())} for each in said["effects"]]


def _verdict_right(truth: dict[str, Any], said: dict[str, Any]) -> bool:
    accepted = {name for each in truth["effects"] for name in each["accepted"]}
    names = {each["name"] for each in said["effects"]}
    return bool(said["verdict"] == truth["verdict"] or said["verdict"] in accepted or names & accepted)


def interval_overlap(first: Sequence[Sequence[float]], second: Sequence[Sequence[float]], duration: float) -> float:
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
    return interval_overlap(truth["location"]["time"], location.get("time", []), duration)


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)
