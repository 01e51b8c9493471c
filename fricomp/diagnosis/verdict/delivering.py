"""The models that are handed over with a verdict, and whether they bear it out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from fricomp.model import FrictionModel
from fricomp.recording import Recording

from ..delivery.models import Delivery, deliver_models
from ..effects import EFFECTS
from ..effects.outside.payload_error import PayloadError
from ..evidence.findings import Findings
from ..evidence.undetermined import cancels_with_gravity, list_undetermined
from ..inputs.checks import PART_OF
from ..record.file_errors import FileErrors
from ..search.choice import choose
from ..search.search import SearchResult
from .extension import write_base_model, write_extended_model
from .given_model import write_given_model
from .judging import Verdict
from .settings import VERDICT

LOAD = PayloadError.name
WORSE = "the model with it is worse than that without on data left out"


def deliver(findings: Findings, verdict: Verdict, whole: Sequence[Recording]) -> Delivery | None:
    """The models that are handed over with the answer; None where the joint obeys no law of its own motion.

    Args:
        findings: Evidence from the rows.
        verdict: What was judged of it.
        whole: All that is usable, where stretches of it were searched.
    """
    case, sample = findings.case, verdict.sample
    if sample is not None and sample.lawless:
        return None
    undetermined = list_undetermined(findings.refitted, (case.unit, case.position_unit))
    cancels = cancels_with_gravity(findings.refitted)
    loads = _split_loads(findings, whole)
    first = case.baseline if loads is None else findings.refitted
    base = write_base_model(case.recordings, first, cancels=cancels)
    joint = None if findings.chosen is None else findings.refitted
    rows = write_extended_model(case.recordings, joint, case.spring, cancels=cancels)
    extended = rows if sample is None else sample.extend((rows if sample.waves else None) or base)
    named = [one.name for one in verdict.effects if one.kind == "physics"]
    missing = [name for name in named if extended is None or not EFFECTS[name].is_in_law(extended.law)]
    names = [rows.name for rows in findings.series]
    given = write_given_model(findings, base) if verdict.held.before == "given" else None
    used, names, whole = (case.recordings, names, whole) if loads is None else loads
    found = deliver_models(used, base, extended, missing, names=names, given=given, whole=whole)
    noted = None if found.extended is None else _note(found.extended, undetermined)
    remarks = found.remarks if loads is None else (_describe_load(names[0]), *found.remarks)
    remarks += _describe_beyond(list_beyond_law(verdict), found)
    return replace(found, base=_note(found.base, undetermined), extended=noted, remarks=remarks)


class _FirstLoad(NamedTuple):
    """The recordings that were made with the load of the first one, their names, and all that is usable of it."""

    recordings: Sequence[Recording]
    names: list[str]
    whole: Sequence[Recording]


def _split_loads(findings: Findings, whole: Sequence[Recording]) -> _FirstLoad | None:
    """The first load's share of the data, where the recordings were made with different ones; None where they were not.

    A written model has one inertia and one gravity: fitted to several loads they would be of none of them, and the
    friction would bend to make up for it.
    """
    case, chosen = findings.case, findings.chosen
    contexts = case.baseline.structure.contexts
    if chosen is None or LOAD not in chosen.names or not any(context.source for context in contexts):
        return None
    rows = [k for k, context in enumerate(contexts) if context.source == 0]
    number = case.recordings[0].metadata.extra.get(PART_OF)
    return _FirstLoad(
        [case.recordings[k] for k in rows],
        [findings.series[k].name for k in rows],
        [one for one in whole if one.metadata.extra.get(PART_OF) == number],
    )


def _describe_load(name: str) -> str:
    return (
        f"Careful: friction.json holds inertia and gravity of the joint as loaded in {name}, on which it was judged; "
        f"for the other loads add what {LOAD} says to them. The friction is that of all recordings."
    )


def list_beyond_law(verdict: Verdict) -> list[str]:
    """Numbers that were found to be there and have no place in a model's law, as "inertia of end_stop"."""
    return [
        f"{number} of {one.name}"
        for one in verdict.effects
        if one.name in EFFECTS
        for number in EFFECTS[one.name].beyond_law
        if number in one.parameters and one.parameters[number].ci95[0] > 0.0
    ]


def _describe_beyond(beyond: Sequence[str], delivery: Delivery) -> tuple[str, ...]:
    """Say that the written model is worse for what it has no place for."""
    if not beyond or not _is_worse(delivery.errors):
        return ()
    return (f"Careful: friction.json has no place for the {', '.join(beyond)}, and is worse for it than without.",)


def _is_worse(errors: FileErrors | None) -> bool:
    """Whether the model with what is named does clearly worse on data left out than that without."""
    return errors is not None and errors.compare() > 1.0 + VERDICT.worse


def _note(model: FrictionModel, undetermined: Sequence[str]) -> FrictionModel:
    """The model with a note on those of its numbers that the recordings do not determine."""
    if not undetermined:
        return model
    notes = {**model.provenance.notes, "undetermined": ", ".join(undetermined)}
    return replace(model, provenance=replace(model.provenance, notes=notes))


def leave_out_worse(findings: Findings, verdict: Verdict, delivery: Delivery | None) -> SearchResult | None:
    """What was found without the effects with which the model that is handed over does worse on data left out; None
    where it does not.

    The rows weigh each moment by what is known of it; a user has the error alone. What lowers the one and raises the
    other has been fitted to some few rows.
    """
    found, chosen = findings.case.found, findings.chosen
    errors = None if delivery is None or verdict.sample is not None else delivery.errors
    if chosen is None or errors is None or errors.missing or not _is_worse(errors):
        return None
    if list_beyond_law(verdict):  # the model may be worse for what it cannot say
        return None
    names = {name for name in chosen.names if EFFECTS[name].kind == "physics"}
    rest = [one for one in found.explanations if not names & set(one.names)]
    out = [replace(one, refused=one.refused or WORSE) for one in found.explanations if names & set(one.names)]
    best = choose(findings.case.baseline, rest, found.threshold)
    return replace(found, explanations=(*rest, *out), best=best) if names else None
