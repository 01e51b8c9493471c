"""The probability of an answer: how often it comes again, and how often such answers were right."""

from __future__ import annotations

from collections.abc import Sequence

from ..evidence.findings import Findings
from ..record.result import NamedEffect
from ..samples.sample_finding import SampleFinding
from .settings import PROBABILITY

NOTHING, UNKNOWN = "nothing", "unknown"
"""Keys beside the names of effects."""


def compute_probability(share: float) -> float:
    """Probability that a name is right which comes again in this share of the repetitions."""
    return PROBABILITY.at_none + (PROBABILITY.at_all - PROBABILITY.at_none) * float(share**PROBABILITY.power)


def list_probabilities(
    findings: Findings,
    effects: Sequence[NamedEffect],
    sample: SampleFinding | None,
    read_off: Sequence[str] = (),
) -> dict[str, float]:
    """List the probability of each name that came up, of nothing and of something unknown, the named ones first.

    Args:
        findings: Evidence from the rows, with its repetitions.
        effects: What is named.
        sample: What the samples show, where the answer rests on that.
        read_off: Names that two channels show of each other, without a choice among explanations.
    """
    repetitions = findings.trial.repetitions
    shares = {one.name: 0.0 for one in effects} | repetitions.shares | dict(findings.shift_shares)
    shares |= dict.fromkeys(read_off, 1.0)
    if findings.lag is not None:  # read off two channels as well
        shares[findings.lag.name] = 1.0
    if sample is not None:
        shares[sample.name] = sample.share
    shifted = max(findings.shift_shares.values(), default=0.0)
    beside = 0.0 if sample is None else sample.share  # the rows leave open what the samples show
    nothing = repetitions.nothing / max(repetitions.count, 1) * (1.0 - shifted) * (1.0 - beside)
    unknown = repetitions.unknown / max(repetitions.count, 1) * (1.0 - beside)
    shares |= {NOTHING: nothing, UNKNOWN: unknown}
    return {name: compute_probability(share) for name, share in shares.items()}
