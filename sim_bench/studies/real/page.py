"""The page on real recordings: what was found, beside what is known, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fricomp.diagnosis.report import VERDICT_TITLES, format_quantity
from fricomp.report import format_markdown_table

from .run import RealOutcome

__all__ = ["write_real_page"]

_INTRODUCTION = """# The diagnosis on real recordings

Public recordings of joints that nobody here made, through the same `diagnose` as any other: no simulation is given,
so a rigid joint with bidirectional Stribeck friction is identified from the recording and serves as the simulation;
the two sessions of an arm come with its kinematics, which a payload is computed with. What the diagnosis knows of a
file are its samples and the metadata of the [mapping](recordings.md); no setting belongs to one file. But these sets
were looked at while the diagnosis was developed, and what went wrong on them was mended where it could be: they are
development data, and do not say how often it is right on a recording that nobody looked at before.

    fricomp bench real --page docs/real.md --out runs/real

The data are not in the project; [recordings](recordings.md#public-data-sets) says where they come from. Errors are on
data that took no part in the fit: whole recordings, one after another, where a case has several; blocks of time where
it has one, and for ripples, drives and presliding found in the samples; the last third of each session for an arm. They
are of residuals averaged over tens of milliseconds, or of single samples where a ripple, a drive or presliding was
found in the samples. So they compare with each other in a row, and with published figures only roughly.
"""
_MARK = {True: "yes", False: "**no**", None: "nothing promised"}


def write_real_page(outcomes: Sequence[RealOutcome], page: Path, measured: str) -> None:
    """Write the Markdown page.

    Args:
        outcomes: Of all cases.
        page: File.
        measured: When, and of which diagnosis.
    """
    sections = [_INTRODUCTION.strip(), f"{measured}\n\n{_overview(outcomes)}", *map(_section, outcomes)]
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n\n".join(sections) + "\n", encoding="utf-8")


def _overview(outcomes: Sequence[RealOutcome]) -> str:
    head = ["recording", "answer", "held-out error, before → after (floor)", "known: found", "as expected", "time [s]"]
    rows = [
        [one.case.name, _answer(one), _errors(one), _values(one), _mark(one), f"{one.seconds:.0f}"] for one in outcomes
    ]
    return f"{format_markdown_table(head, rows)}\n\n{_count(outcomes)}"


def _count(outcomes: Sequence[RealOutcome]) -> str:
    """How many of those in which effects are known name one, and what is named beside."""
    known = [one for one in outcomes if one.case.effects]
    named = [one for one in known if one.named & one.case.effects]
    in_set = [one for one in known if one.names & one.case.effects and one not in named]
    others = [f"{one.case.name} ({', '.join(sorted(one.others))})" for one in known if one.others]
    controls = [one for one in outcomes if not one.case.effects and one.reached is not None]
    sentences = [
        f"Of {len(known)} in which effects are known, {len(named)} name one of them, {len(in_set)} more have it in a "
        f"set, {len(known) - len(named) - len(in_set)} do not find it.",
        f"Other names: {'; '.join(others) or 'none'}.",
        f"Controls without what must not be named: {sum(bool(one.reached) for one in controls)} of {len(controls)}.",
        f"Nothing known: {len(outcomes) - len(known) - len(controls)}.",
    ]
    return " ".join(sentences)


def _is_listed(outcome: RealOutcome) -> bool:
    """Whether effects are known of a case that promises none."""
    return outcome.reached is None and bool(outcome.case.listed)


def _values(outcome: RealOutcome) -> str:
    """What is known of the parameters, beside what was found."""
    parts = [f"{name.replace('_', ' ')} {known:.4g}: {format_quantity(q)}" for name, known, q in outcome.found_values]
    return "; ".join(parts) or "–"


def _mark(outcome: RealOutcome) -> str:
    if outcome.reached and outcome.case.expected and not outcome.named & set(outcome.case.expected):
        return "in its alias set"
    if _is_listed(outcome):
        return f"found: {', '.join(sorted(outcome.found))}" if outcome.found else "not found"
    return _MARK[outcome.reached]


def _answer(outcome: RealOutcome) -> str:
    if outcome.record is None:
        return "none"
    names = ", ".join(f"`{effect.name}`" for effect in outcome.record.effects)
    return names or VERDICT_TITLES[outcome.record.verdict]


def _errors(outcome: RealOutcome) -> str:
    held = outcome.record.heldout if outcome.record is not None else None
    if held is None:
        return "–"
    return f"{held.rmse_before:.3g} → {held.rmse_after:.3g} ({held.noise_floor:.2g}) {held.unit}"


def _section(outcome: RealOutcome) -> str:
    case, lines = outcome.case, [f"## {outcome.case.name}", "", f"Known: {outcome.case.hidden}."]
    if case.published:
        lines.append(f"Others: {case.published}.")
    if case.remark and not outcome.reached and not (_is_listed(outcome) and outcome.found):
        lines.append(f"Why it does not come out: {case.remark}.")
    lines.append("")
    if outcome.record is None:
        lines.append(f"No answer: {outcome.error}")
        return "\n".join(lines)
    lines += [f"- {sentence}" for sentence in outcome.record.sentences]
    if outcome.strongest_rejected:
        lines.append(f"- The strongest other name that was refused: {outcome.strongest_rejected}.")
    table = _base(outcome)
    return "\n".join([*lines, "", table] if table else lines)


def _base(outcome: RealOutcome) -> str:
    """Parameters of the refitted base in one line."""
    sides = [f"{side}.{name}" for side in ("forward", "reverse") for name in ("coulomb_torque", "viscous_coefficient")]
    wanted = ["inertia", "offset", *sides]
    base = outcome.record.base if outcome.record is not None else {}
    parts = [f"{name.replace('_', ' ')} {format_quantity(base[name])}" for name in wanted if name in base]
    return f"Base: {', '.join(parts)}." if parts else ""
