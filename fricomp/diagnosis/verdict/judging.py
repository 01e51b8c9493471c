"""The stage that judges: from the evidence to the verdict and its names. It computes nothing but that."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from ..evidence.findings import Findings
from ..record.result import Change, HeldOut, Kind, Location, NamedEffect, Rival, VerdictName
from ..samples.sample_finding import SampleFinding
from ..search.settings import SEARCH
from .naming import compare_spring, name_effects, name_sample
from .rivals import list_rivals, list_sample_rivals
from .settings import VERDICT
from .shared_effect import SharedEffects, SimulationEffects, share_effects


@dataclass(frozen=True)
class Verdict:
    """The answer to a case, before it is written down.

    Attributes:
        word: The answer in one word.
        effects: What is named, strongest first.
        held: Errors on held-out data.
        location: Where the mismatch sits.
        noise_ratio: Residual of the base over its noise.
        coverage: Part of the explainable energy that is covered; None where nothing stood out.
        changes: Parameters of the given simulation that the refit moved.
        rivals: Explanations that were weighed.
        undecided: Whether an effect of the search cannot be told from another one.
        shared: Which of the effects the simulation has itself.
        sample: What the samples show, where the answer rests on that; else None.
        read_off: Names that two channels show of each other, without a choice among explanations.
    """

    word: VerdictName
    effects: tuple[NamedEffect, ...]
    held: HeldOut
    location: Location
    noise_ratio: float
    coverage: float | None
    changes: tuple[Change, ...]
    rivals: tuple[Rival, ...]
    undecided: bool
    shared: SharedEffects
    sample: SampleFinding | None = None
    read_off: tuple[str, ...] = ()


def judge(
    findings: Findings, sample: SampleFinding | None = None, simulated: SimulationEffects | None = None
) -> Verdict:
    """Judge what the rows and the samples show.

    Args:
        findings: Evidence from the rows of the residual.
        sample: What the samples show besides; None where they show nothing.
        simulated: Effects that the simulation has itself; None where nobody looked for them.
    """
    named = name_effects(findings, findings.held.explained)
    if sample is None or not _replaces_search(sample, findings):
        return _judge_rows(findings, named, share_effects(named, simulated))
    return _judge_samples(findings, sample, named, simulated)


def judge_beside(findings: Findings, sample: SampleFinding, simulated: SimulationEffects | None = None) -> Verdict:
    """Judge a ripple of the samples together with what the rows show without it.

    Args:
        findings: Evidence from the rows of the recordings without the ripple.
        sample: The ripple.
        simulated: Effects that the simulation has itself; None where nobody looked for them.
    """
    left = 1.0 - sample.held.explained
    rows = name_effects(findings, 0.0 if findings.as_given else left * findings.held.explained)
    own = name_sample(sample)
    effects = (own, *(one for one in rows if one.name != own.name and not _repeats(one, sample)))
    shared = share_effects(effects, simulated)
    first = Rival(effects=tuple(one.name for one in effects), gain=0.0)
    rivals = tuple(one for one in list_rivals(findings) if one.refused)
    return Verdict(
        word=choose_verdict(shared.kinds),
        effects=shared.effects,
        held=sample.held,
        location={},
        noise_ratio=sample.held.rmse_before / max(sample.held.noise_floor, 1e-30),
        coverage=sample.held.explained,
        changes=(*findings.comparison.changes, *compare_spring(rows, findings.case.spring)),
        rivals=(first, *rivals),
        undecided=any(one.indistinguishable_from for one in shared.effects if one.name != own.name),
        shared=shared,
        sample=sample,
    )


def _repeats(one: NamedEffect, sample: SampleFinding) -> bool:
    """Whether an effect is a ripple of an order that the samples show: two ripples of one order have one cause."""
    order, known = one.parameters.get("order"), [wave.order for waves in sample.waves for wave in waves]
    return order is not None and any(abs(order.value - other) < SEARCH.same_order * other for other in known)


def join_channels(verdict: Verdict, shown: Sequence[NamedEffect]) -> Verdict:
    """Name what two channels show of each other beside what rows and samples show.

    A torque that is late as the rows show it is not told again as one that is late behind its command.

    Args:
        verdict: On rows and samples.
        shown: What the channels show.
    """
    named = {one.name for one in verdict.effects}
    late = {"torque_delay", "drive_lag"}
    known = named | late if named & late else named
    new = tuple(one for one in shown if one.name not in known)
    if not new:
        return verdict
    kinds = verdict.shared.kinds | {one.kind for one in new}
    return replace(
        verdict,
        word=choose_verdict(kinds, unknown=verdict.word == "unknown_physics"),
        effects=(*verdict.effects, *new),
        read_off=(*verdict.read_off, *(one.name for one in new)),
    )


def choose_verdict(kinds: Collection[Kind], *, unknown: bool = False) -> VerdictName:
    """Choose the verdict on effects of these kinds, the gravest of which counts.

    Args:
        kinds: Of the effects.
        unknown: Whether something is missing besides that no effect explains.
    """
    if "physics" in kinds:
        return "missing_physics"
    if unknown:
        return "unknown_physics"
    if "measurement" in kinds:
        return "measurement"
    return "parameters" if kinds else "consistent"


def describe_repetitions(verdict: Verdict, others: Sequence[Verdict]) -> tuple[str, ...]:
    """Say how often whole diagnoses by other noise give the same verdict and names; nothing where there are none."""
    if not others:
        return ()
    own = verdict.word, {one.name for one in verdict.effects}
    same = sum(own == (other.word, {one.name for one in other.effects}) for other in others)
    return (
        f"By nulls of other noise the whole diagnosis gives the same verdict and names in {same} of {len(others)}.",
    )


def _replaces_search(sample: SampleFinding, findings: Findings) -> bool:
    """Whether a ripple of the samples is another and larger one than that of the rows, where these show one."""
    coarse = findings.named_ripple
    if coarse is None or sample.ripple is None:
        return True
    order, amplitude = sample.ripple
    return order > VERDICT.other_order * coarse[0] and amplitude > VERDICT.larger * coarse[1]


def _judge_rows(findings: Findings, named: tuple[NamedEffect, ...], shared: SharedEffects) -> Verdict:
    best, held = findings.case.found.best, findings.held
    searched = {one.effect.name for one in findings.effects}
    return Verdict(
        word=choose_verdict(shared.kinds, unknown=findings.unknown),
        effects=shared.effects,
        held=HeldOut(
            rmse_before=held.rmse_before,
            rmse_after=held.rmse_after,
            noise_floor=held.noise_floor,
            unit=findings.case.unit,
            ci95_reduction=held.ci95_reduction,
            explained=held.explained,
            before="given" if findings.as_given else "refitted",
        ),
        location=findings.location,
        noise_ratio=findings.noise_ratio,
        coverage=best.coverage if best is not None else None,
        changes=(*findings.comparison.changes, *compare_spring(named, findings.case.spring)),
        rivals=list_rivals(findings),
        undecided=any(one.indistinguishable_from for one in shared.effects if one.name in searched),
        shared=shared,
    )


def _judge_samples(
    findings: Findings, sample: SampleFinding, named: tuple[NamedEffect, ...], simulated: SimulationEffects | None
) -> Verdict:
    """What differs from the given simulation and friction stays as it is, unless the joint obeys no law at all.

    The error is then counted from the base refitted, so that none of that has a share.
    """
    held = sample.held
    rows = name_effects(findings, 0.0) if findings.as_given else named
    order = [one.name for one in named]
    compared = sorted((one for one in rows if one.share == 0.0), key=lambda one: order.index(one.name))
    effects = (name_sample(sample), *(() if sample.lawless else compared))
    shared = share_effects(effects, simulated)
    changes = (*findings.comparison.changes, *compare_spring(named, findings.case.spring))
    return Verdict(
        word=choose_verdict(shared.kinds),
        effects=shared.effects,
        held=held,
        location={},
        noise_ratio=held.rmse_before / max(held.noise_floor, 1e-30),
        coverage=held.explained,
        changes=() if sample.lawless else changes,
        rivals=sample.rivals or list_sample_rivals(findings, effects, named),
        undecided=False,
        shared=shared,
        sample=sample,
    )
