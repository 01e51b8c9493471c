"""The score of one case: what was concealed against what was answered."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricomp.errors import DiagnosisError

from .blind import BlindAnswer
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
_SIMULATION = "simulation"  # what stands for the parameters of a shifted simulation among the effects
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
        gap_closed: Energy above the diagnosis' own noise floor that was removed on held-out data; NaN where no effect
            of physics or measurement was named that changes the residual. That floor is at most the error that is
            left, so this is no share of what the right structure could close: `gap` measures that.
        noise_ratio: Residual of the base model over its noise floor, as the diagnosis sees it; NaN where not given.
        parameters: Number of parameters that can be compared: of concealed effects that were named, and the refitted
            inertia and gravity where those of the simulation were shifted and found to be. Counts, such as an order,
            have no interval.
        covered: How many of their 95 % intervals hold the truth.
        coverage: The same for each concealed effect that was named, such as `cogging 3/3`, and for a shifted
            `simulation`, joined by a plus sign.
        worst_error: Largest relative error of them; NaN for none.
        proposed: It proposed a motion to tell a printed set apart.
        recorded: That motion could be recorded, and both recordings were diagnosed together.
        resolved: With it, a concealed effect was named alone.
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
    gap_closed: float
    noise_ratio: float
    parameters: int
    covered: int
    coverage: str
    worst_error: float
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
    return Score(
        group=planned.group,
        **_compare(json.loads(answer), read_diagnosis(blind.diagnosis)),
        proposed=asks_for_more(blind),
        recorded=follow_up is not None,
        resolved=follow_up is not None and _resolved(json.loads(answer), read_diagnosis(follow_up.diagnosis)),
        seconds=blind.seconds,
        error=blind.error,
        command=command_of(planned.spec),
    )


def score_again(score: Score, answer: bytes, diagnosis: bytes) -> Score:
    """A score by the rules of today, of the answer and the diagnosis that it came from.

    Times, and what became of a proposed motion, are known to the run alone and stay.
    """
    return replace(score, **_compare(json.loads(answer), read_diagnosis(diagnosis)))


def _compare(truth: dict[str, Any], said: dict[str, Any]) -> dict[str, Any]:
    """All of a score that follows from the answer and the diagnosis."""
    coverage, worst = _score_parameters(truth, said)
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
        "gap_closed": _gap_closed(said),
        "noise_ratio": _number(said.get("noise_ratio")),
        "parameters": sum(total for _, total in coverage.values()),
        "covered": sum(covered for covered, _ in coverage.values()),
        "coverage": "+".join(f"{name} {covered}/{total}" for name, (covered, total) in coverage.items()),
        "worst_error": worst,
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
    sets = [{each["name"], *each.get("indistinguishable_from", ())} for each in said["effects"]]
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


def _resolved(truth: dict[str, Any], said: dict[str, Any]) -> bool:
    """Whether a concealed effect comes first and alone in its set."""
    names = _score_names(truth, said)
    return bool(names["top_right"]) and not said["effects"][0].get("indistinguishable_from")


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


def _gap_closed(said: dict[str, Any]) -> float:
    heldout = said.get("heldout")
    named = [each for each in said["effects"] if each["kind"] != "parameter" and each.get("share", 0.0) > 0.0]
    if not heldout or not named:
        return float("nan")
    before, after, floor = (heldout[name] ** 2 for name in ("rmse_before", "rmse_after", "noise_floor"))
    return float((before - after) / (before - floor)) if before > floor else float("nan")


def _score_parameters(truth: dict[str, Any], said: dict[str, Any]) -> tuple[dict[str, tuple[int, int]], float]:
    """For each effect how many intervals hold the truth and how many could; the largest relative error of all."""
    answers = {each["name"]: each["parameters"] for each in said["effects"]}
    pairs = {each["name"]: (answers.get(each["name"], {}), _values(each["comparable"])) for each in truth["effects"]}
    if "gravity" in truth["joint"] and answers.keys() & set(truth["shifted_parameters"]):
        pairs[_SIMULATION] = (_refitted(said), _body_of(truth["joint"]))
    coverage, errors = {}, []
    for effect, (found, wanted) in pairs.items():
        if _numbered(found) != _numbered(wanted):
            continue  # where one push is missed, which of the others is the second is a matter of counting
        compared = [(given, wanted[name]) for name, given in found.items() if name in wanted and _has_width(given)]
        if compared:
            held = sum(given["ci95"][0] <= value <= given["ci95"][1] for given, value in compared)
            coverage[effect] = (held, len(compared))
            errors += [abs(given["value"] / value - 1.0) if value else np.nan for given, value in compared]
    return coverage, float(np.max(errors)) if errors else float("nan")


def _values(parameters: Mapping[str, Any]) -> dict[str, float]:
    return {name: each["value"] for name, each in parameters.items()}


def _refitted(said: dict[str, Any]) -> dict[str, Any]:
    """What a diagnosis says has changed in the simulation, with its interval."""
    return {each["name"]: each["refitted"] for each in said.get("changes") or () if each.get("refitted")}


def _body_of(joint: Mapping[str, Any]) -> dict[str, float]:
    """Inertia and gravity of the concealed joint by the names of a diagnosis."""
    gravity, angle = joint["gravity"], joint["gravity_angle"]
    return {
        "inertia": joint["inertia"],
        "gravity_cos": gravity * float(np.sin(angle)),
        "gravity_sin": gravity * float(np.cos(angle)),
    }


def _has_width(given: Mapping[str, Any]) -> bool:
    """Whether a parameter has an interval; counts, such as the order of a filter, have none."""
    return bool(given["ci95"][0] < given["ci95"][1])


def _numbered(parameters: Mapping[str, Any]) -> int:
    """How many of the same thing an effect has, such as pushes."""
    return sum(name.startswith("start_") for name in parameters)


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)
