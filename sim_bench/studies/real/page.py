"""The page on real recordings: what was found, beside what is known, in Markdown."""

from collections.abc import Sequence
from pathlib import Path

from fricomp.diagnosis.report import VERDICT_TITLES, format_quantity

from ..kit.page import write_page
from .run import RealOutcome

_MARK = {True: "yes", False: "**no**", None: "nothing promised"}


def write_real_page(outcomes: Sequence[RealOutcome], page: Path, measured: str) -> None:
    """Write the Markdown page.

    Args:
        outcomes: Of all cases.
        page: File.
        measured: When, and at which commit.
    """
    write_page(
        "real/page.md",
        page,
        outcomes=outcomes,
        measured=measured,
        overview=[
            [
                one.case.name,
                _format_answer(one),
                _format_errors(one),
                _format_values(one),
                _format_mark(one),
                f"{one.seconds:.0f}",
            ]
            for one in outcomes
        ],
        counts=_count_outcomes(outcomes),
        bases={one.case.name: _format_base(one) for one in outcomes},
    )


def _count_outcomes(outcomes: Sequence[RealOutcome]) -> str:
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


def _format_values(outcome: RealOutcome) -> str:
    """What is known of the parameters, beside what was found."""
    parts = [f"{name.replace('_', ' ')} {known:.4g}: {format_quantity(q)}" for name, known, q in outcome.found_values]
    return "; ".join(parts) or "–"


def _format_mark(outcome: RealOutcome) -> str:
    if outcome.reached and outcome.case.expected and not outcome.named & set(outcome.case.expected):
        return "in its alias set"
    if outcome.is_listed:
        return f"found: {', '.join(sorted(outcome.found))}" if outcome.found else "not found"
    return _MARK[outcome.reached]


def _format_answer(outcome: RealOutcome) -> str:
    if outcome.record is None:
        return "none"
    names = ", ".join(f"`{effect.name}`" for effect in outcome.record.effects)
    return names or VERDICT_TITLES[outcome.record.verdict]


def _format_errors(outcome: RealOutcome) -> str:
    held = outcome.record.heldout if outcome.record is not None else None
    if held is None:
        return "–"
    return f"{held.rmse_before:.3g} → {held.rmse_after:.3g} ({held.noise_floor:.2g}) {held.unit}"


def _format_base(outcome: RealOutcome) -> str:
    """Parameters of the refitted base in one line."""
    sides = [f"{side}.{name}" for side in ("forward", "reverse") for name in ("coulomb_torque", "viscous_coefficient")]
    wanted = ["inertia", "offset", *sides]
    base = outcome.record.base if outcome.record is not None else {}
    parts = [f"{name.replace('_', ' ')} {format_quantity(base[name])}" for name in wanted if name in base]
    return f"Base: {', '.join(parts)}." if parts else ""
