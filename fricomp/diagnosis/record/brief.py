"""The answer in short: what is wrong, where, what it is, what to do; for a terminal, made from the record alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .result import FRICTION_CHANGES, DiagnosisRecord, NamedEffect, VerdictName

_TO_DO: Final[dict[VerdictName, str]] = {
    "consistent": "take the friction from friction.json. What this motion does not excite, it does not show.",
    "parameters": "take the refitted values over into the simulation.",
    "measurement": "mend the signal, or take it into account where the log is read; then record and diagnose again.",
    "missing_physics": "put the equation into the simulation, or compensate with friction.json (after fricomp "
    "check-loop).",
    "unknown_physics": "add no effect, but look at the joint there; friction.json holds what is known.",
    "bad_data": "mend what these sentences name and record or convert anew; no model was written.",
}
_KINDS: Final[dict[VerdictName, str]] = {
    "consistent": "",
    "parameters": "parameter",
    "measurement": "measurement",
    "missing_physics": "physics",
}
"""Of the effects that a verdict is about."""

TOO_MUCH_LEFT = "leaves too much unexplained"
"""Why an explanation that is possible is none."""
_UNSURE = " is not named: "


def write_summary(
    record: DiagnosisRecord, opening: str, lead: Sequence[str], where: str, gain: str, facts: Sequence[str]
) -> tuple[str, ...]:
    """Sentences in which a newcomer reads what is wrong, where it shows, what to do, and what it is.

    Args:
        record: Everything else.
        opening: The verdict in a sentence.
        lead: What was found to stand right behind it.
        where: Where the mismatch sits; empty where nobody looked.
        gain: What the written models are worth; empty where none is written.
        facts: What else the sentences of the answer say.
    """
    to_do = f"To do: {_say_what_to_do(record)}"
    if record.verdict == "bad_data":
        return (opening, *lead, *facts, to_do)
    careful = (fact for fact in facts if "Careful: " in fact)
    explained = map(_explain, record.effects)
    opening, closest = _name_all(opening, record), _tell_closest(record)
    lines = (opening, where, closest, to_do, *lead, *explained, _list_other_changes(record), gain)
    return tuple(line for line in (*lines, _doubt(facts), *careful) if line)


def _name_all(opening: str, record: DiagnosisRecord) -> str:
    """The opening with the names that it is about, and behind it those that stand beside."""
    kind = _KINDS.get(record.verdict)
    own = [effect.name for effect in record.effects if effect.kind == kind]
    beside = [effect.name for effect in record.effects if effect.kind != kind]
    if not own and kind is not None:
        own, beside = beside, []
    first = f"{opening.rstrip('.')}: {', '.join(own)}." if own else opening
    return f"{first} Found beside it: {', '.join(beside)}." if beside else first


def _tell_closest(record: DiagnosisRecord) -> str:
    """What of the catalogue comes closest where nothing is named, if it covers more than it leaves."""
    if record.verdict != "unknown_physics":
        return ""
    possible = [one for one in record.rivals if one.refused == TOO_MUCH_LEFT and (one.coverage or 0.0) > 0.5]
    if not possible:
        return ""
    best = max(possible, key=lambda one: one.gain)
    names = " with ".join(best.effects)
    return f"Closest comes {names}: it covers {best.coverage:.0%} of what lies above the noise, too little for a name."


def _explain(effect: NamedEffect) -> str:
    text = f"{effect.name}: {effect.sentence}{f' [{effect.equation}]' if effect.equation else ''}."
    others = " or ".join(effect.indistinguishable_from)
    return f"{text} This recording cannot tell it from {others}." if others else text


def _list_other_changes(record: DiagnosisRecord) -> str:
    """Parameters that are off beside what was named, by what shows in two digits; where nothing was named, they are the
    answer and stand in a table."""
    moved = [one for one in record.changes if one.name not in FRICTION_CHANGES] if record.effects else []
    told = (
        f"{one.name.replace('_', ' ')} {one.refitted.value:.3g} {one.refitted.unit}, not {one.given:.3g}"
        for one in moved
        if not one.refitted.ci95[0] <= one.given <= one.refitted.ci95[1]
        and f"{one.refitted.value:.2g}" != f"{one.given:.2g}"
    )
    listed = "; ".join(told)
    return f"Off in the simulation: {listed}." if listed else ""


def _doubt(facts: Sequence[str]) -> str:
    """Names that came up and are not among the effects, by the sentences that say why."""
    names = [fact.partition(_UNSURE)[0] for fact in facts if _UNSURE in fact]
    return f"Came up, but too unsure to be named: {', '.join(names)}." if names else ""


def _say_what_to_do(record: DiagnosisRecord) -> str:
    if record.verdict == "missing_physics" and all(effect.kind == "measurement" for effect in record.effects):
        return _TO_DO["measurement"]
    if record.verdict == "missing_physics" and not record.base:  # no motion that shows the joint, and so no model
        return "put the equation into the simulation; no friction model was written."
    if record.effects and record.errors is not None and record.errors.gets_worse:
        return (
            "look at the joint there, and compensate with none of this: on data left out the model with what is named "
            "is no better than that without."
        )
    names = {effect.name for effect in record.effects}
    if names == {"payload_error"} and not any(one.endswith("_change") for one in record.effects[0].parameters):
        return "take the friction from friction.json, and by how much the loads differ from the table."
    if names == {"external_disturbance"}:
        return (
            "find what acts on the joint at these times, or leave them out (--from, --to): it is no part of the joint."
        )
    if names and record.errors is not None and names <= set(record.errors.missing):
        return (
            "put the equation into the simulation; friction.json has no term for it, and holds the rest of the joint."
        )
    return _TO_DO[record.verdict]
