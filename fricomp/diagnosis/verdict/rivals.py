"""The explanations that were weighed, each with what speaks against it."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec.structs import replace

from ..evidence.findings import Findings
from ..record.brief import TOO_MUCH_LEFT
from ..record.result import NamedEffect, Rival
from ..record.sentence import FOREIGN_CURVE
from ..search.explanation import Explanation
from .settings import VERDICT


def list_rivals(findings: Findings) -> tuple[Rival, ...]:
    """List what the search weighed, best first."""
    found, chosen = findings.case.found, findings.chosen
    listed = found.explanations[: VERDICT.rivals]
    if chosen is not None and chosen not in listed:
        listed = (*listed, chosen)
    return tuple(
        Rival(effects=one.names, gain=one.gain, coverage=one.coverage, refused=_explain_refusal(findings, one))
        for one in listed
    )


def _explain_refusal(findings: Findings, one: Explanation) -> str:
    """What speaks against an explanation; empty for the chosen one."""
    chosen = findings.chosen
    if one.refused:
        return one.refused
    if one.certain <= findings.case.found.threshold:
        return "does not exceed what a recording with nothing missing gives"
    if one.common_order is not None:
        return "ripple of torque and of friction at one order come from one part, such as a detent"
    if one.foreign_curve:
        return FOREIGN_CURVE
    against = findings.trial.objections
    if chosen is not one and set(one.names) & set(against):
        return "; ".join(f"{name}: {against[name]}" for name in one.names if name in against)
    if one is findings.trial.failed:
        return "does not make the held-out error fall for sure"
    if chosen is None:
        return TOO_MUCH_LEFT
    return "another explanation is better or simpler" if one is not chosen else ""


def list_sample_rivals(
    findings: Findings, effects: Sequence[NamedEffect], named: Sequence[NamedEffect]
) -> tuple[Rival, ...]:
    """List what was weighed beside a finding in the samples.

    What the search named before joins the refused rivals, unless it has the same name.

    Args:
        findings: Evidence from the rows.
        effects: What is named, the finding first.
        named: What the search named.
    """
    old, name = list_rivals(findings), effects[0].name
    refused = [
        Rival(effects=(one.name,), gain=0.0, refused=f"covers {one.share:.0%} of the mismatch in the rows, less here")
        for one in named
        if findings.chosen is not None and one.share > 0.0 and one.name != name
    ]
    same = [rival for rival in old if not rival.refused and rival.effects == (name,)]
    others = [
        rival if rival.refused else replace(rival, refused="covers too little of the mismatch in the samples")
        for rival in old
        if rival not in same
    ]
    return (*(same or [Rival(effects=tuple(one.name for one in effects), gain=0.0)]), *refused, *others)
