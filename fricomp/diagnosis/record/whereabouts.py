"""Where a mismatch sits, in one sentence: the few facts that single it out most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .joint_name import call_joint
from .result import DiagnosisRecord, Interval, Location, NamedEffect

__all__ = ["describe_whereabouts", "list_whereabouts"]


@dataclass(frozen=True)
class WordingSettings:
    """How much a sentence tells of where a mismatch sits.

    Attributes:
        most_facts: Quantities that are told; the first ones single the mismatch out most.
        few_spans: Intervals up to which a quantity tells a place well.
        most_spans: Intervals up to which it tells one at all, and that are told of it.
        beginning: Time after a reversal [s] up to which an interval begins with it: about half of a row.
    """

    most_facts: int = 3
    few_spans: int = 2
    most_spans: int = 3
    beginning: float = 0.02


WORDING = WordingSettings()
_NAMES = {"velocity": "velocity", "load_torque": "load torque"}
_UNNAMED = frozenset({"", "joint", "arm"})  # joints
_SPREAD = "The mismatch is spread over the whole recording: no time, speed, position or load stands out."


def describe_whereabouts(record: DiagnosisRecord) -> str:
    """Which times, speeds, positions, loads and so on carry most of the mismatch; empty where nobody looked."""
    return " ".join(list_whereabouts(record))


def list_whereabouts(record: DiagnosisRecord) -> tuple[str, ...]:
    """The same, one sentence each: of the whole, and of several effects by effect.

    The quantities of a location stand in the order in which they single it out. Of several effects, each has its
    strongest fact behind those of the whole.
    """
    several, facts = len(record.effects) > 1, _list_facts(record, record.location)
    if not several:
        facts = [*(fact for one in record.effects for fact in _describe_rhythm(one)), *facts]
    each = [
        (one.name, [*_describe_rhythm(one), *_list_facts(record, one.location)]) for one in record.effects if several
    ]
    parts = [f"{name} {found[0]}" for name, found in each if found]
    joint = f" in {call_joint(record.joint)}" if record.joint not in _UNNAMED else ""
    lines = [f"Most of the mismatch sits{joint} {'; '.join(facts[: WORDING.most_facts])}."] if facts else []
    lines += [f"By effect: {'; '.join(parts)}."] if parts else []
    if not lines and (record.location or record.verdict == "unknown_physics"):
        return (_SPREAD,)
    return tuple(lines)


def _list_facts(record: DiagnosisRecord, location: Location) -> list[str]:
    """Intervals of each quantity that has few, the most telling first; acceleration, which follows from the others,
    where nothing else has; of a quantity with many, where there is no other, the first ones."""
    known = {name: spans for name, spans in location.items() if spans and name != "frequency"}
    for few in (WORDING.few_spans, WORDING.most_spans):
        found = [name for name, spans in known.items() if len(spans) <= few]
        plain = [name for name in found if name != "acceleration"]
        if plain:
            return [_describe_fact(record, name, known[name]) for name in plain]
    rest = found or [name for name in known if name not in ("time", "acceleration")][:1]
    return [_describe_fact(record, name, known[name]) for name in rest]


def _describe_fact(record: DiagnosisRecord, name: str, spans: Sequence[Interval]) -> str:
    more = f" and {len(spans) - WORDING.most_spans} further stretches" if len(spans) > WORDING.most_spans else ""
    if name == "time_since_reversal" and len(spans) == 1 and spans[0][0] < WORDING.beginning:
        return f"within {spans[0][1]:.3g} s after a reversal"
    said = ", ".join(f"{low:.3g} to {high:.3g}" for low, high in spans[: WORDING.most_spans])
    if name == "time_since_reversal":
        return f"{said} s{more} after a reversal"
    if name == "time":
        first = " of the first recording" if len(record.recordings) > 1 else ""
        return f"at times {said} s{more}{first}"
    unit = _choose_unit(record, name)
    return f"at {_NAMES.get(name, name.replace('_', ' '))} {said}{f' {unit}' if unit else ''}{more}"


def _describe_rhythm(effect: NamedEffect) -> list[str]:
    """What repeats over the position sits in its rhythm; the order of a filter is none."""
    order = effect.parameters.get("order")
    if order is None or order.unit not in ("1/rad", "1/m"):
        return []
    return [f"in the rhythm of the position, at the order {order.value:.4g} {order.unit}"]


def _choose_unit(record: DiagnosisRecord, quantity: str) -> str:
    known = record.base.get("forward.stribeck_velocity")
    speed = "" if known is None else known.unit
    units = {"velocity": speed, "position": speed.removesuffix("/s"), "acceleration": f"{speed}²" if speed else ""}
    units |= {"temperature": "°C", "load_torque": record.heldout.unit if record.heldout is not None else ""}
    return units.get(quantity, "")
