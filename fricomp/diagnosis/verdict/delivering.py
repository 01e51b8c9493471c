"""The models that are handed over with a verdict, and whether they bear it out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fricomp.model import FrictionModel
from fricomp.recording import Recording

from ..delivery.models import Delivery, deliver_models
from ..effects import EFFECTS
from ..evidence.findings import Findings
from ..evidence.undetermined import cancels_with_gravity, list_undetermined
from ..search.choice import choose
from ..search.search import SearchResult
from .extension import write_base_model, write_extended_model
from .given_model import write_given_model
from .judging import Verdict
from .settings import VERDICT

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
    base = write_base_model(case.recordings, case.baseline, cancels=cancels)
    joint = None if findings.chosen is None else findings.refitted
    rows = write_extended_model(case.recordings, joint, case.spring, cancels=cancels)
    extended = rows if sample is None else sample.extend((rows if sample.waves else None) or base)
    named = [one.name for one in verdict.effects if one.kind == "physics"]
    missing = [name for name in named if extended is None or not EFFECTS[name].is_in_law(extended.law)]
    names = [rows.name for rows in findings.series]
    given = write_given_model(findings, base) if verdict.held.before == "given" else None
    found = deliver_models(case.recordings, base, extended, missing, names=names, given=given, whole=whole)
    noted = None if found.extended is None else _note(found.extended, undetermined)
    return replace(found, base=_note(found.base, undetermined), extended=noted)


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
    if chosen is None or errors is None or errors.missing or errors.compare() <= 1.0 + VERDICT.worse:
        return None
    names = {name for name in chosen.names if EFFECTS[name].kind == "physics"}
    rest = [one for one in found.explanations if not names & set(one.names)]
    out = [replace(one, refused=one.refused or WORSE) for one in found.explanations if names & set(one.names)]
    best = choose(findings.case.baseline, rest, found.threshold)
    return replace(found, explanations=(*rest, *out), best=best) if names else None
