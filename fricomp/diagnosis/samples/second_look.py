"""The stage that looks into the samples for what the rows leave open: soft presliding, fine ripple, a late drive.

It gives a candidate; whether that counts is for the verdict to judge. A ripple that counts is taken out of the torque,
and the rows are searched again: what it had covered shows then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fricomp.recording import Recording

from ..evidence.findings import Findings
from ..inputs.track import FloatArray, differentiate
from .drive_path import find_drive_path
from .fine_ripple import FineRipple, Harmonic, find_fine_ripple
from .proving import is_beyond_the_base, is_softer_than_the_base
from .sample_finding import SampleFinding, describe_drive_path, describe_presliding, describe_ripple
from .settings import LOOK
from .soft_presliding import SoftPresliding, find_soft_presliding


def look_into_samples(findings: Findings) -> SampleFinding | None:
    """Look for what the rows cannot show, as far as they leave it open; None where nothing is found.

    Args:
        findings: What the rows show.
    """
    if findings.detent_order is not None:  # one unknown part shows as a ripple in the samples too
        return None
    path = find_drive_path(findings.case.recordings[0]) if _is_lawless(findings) else None
    if path is not None:
        return describe_drive_path(findings, path)
    covered = _is_covered(findings)
    if covered and findings.named_ripple is None:
        return None
    # A base at its noise has a bristle of its own, whatever the comparison with the simulation says.
    soft = _find_bristles(findings) if findings.unknown or (_has_explained(findings) and not covered) else []
    if soft:
        return describe_presliding(findings, soft)
    ripples = _find_ripples(findings)
    return describe_ripple(findings, ripples) if ripples else None


def remove_ripple(recordings: Sequence[Recording], found: SampleFinding) -> tuple[Recording, ...]:
    """The recordings without the torque of the ripple that the samples show."""
    return tuple(
        replace(one, torque=np.asarray(one.torque) - _compute_waves(one, waves))
        for one, waves in zip(recordings, found.waves, strict=True)
    )


def _compute_waves(recording: Recording, waves: Sequence[Harmonic]) -> FloatArray:
    """Torque of a ripple along a recording [N·m] or [N]. Shape (n,)."""
    q = np.asarray(recording.position)
    sign = np.sign(differentiate(q, recording.sample_period)) if any(one.level for one in waves) else np.ones_like(q)
    total = np.zeros_like(q)
    for one in waves:
        wave = one.sine * np.sin(one.order * q) + one.cosine * np.cos(one.order * q)
        total += wave * sign if one.level else wave
    return total


def _has_explained(findings: Findings) -> bool:
    """Whether the search named an effect that makes the held-out error fall, by a torque that shows.

    The energy of a joint that leaves its recording without the effect is no number: that counts as none.
    """
    return findings.held.explained > 0.0 and any(one.energy > 0.0 for one in findings.effects)


def _is_covered(findings: Findings) -> bool:
    """Whether the search named something that takes the mismatch away on held-out data, of whatever kind."""
    return _has_explained(findings) and findings.held.explained >= LOOK.covered


def _find_bristles(findings: Findings) -> list[SoftPresliding]:
    """The bristle of each recording, where the base alone would show none; empty where one of them has none."""
    found = []
    for recording in findings.case.recordings:
        soft = find_soft_presliding(recording)
        if soft is None or not is_softer_than_the_base(recording, soft, findings.base, findings.case.seed):
            return []
        found.append(soft)
    return found


def _find_ripples(findings: Findings) -> list[FineRipple]:
    """The ripple of each recording, where it is more than the base alone would show; empty where one has none."""
    found = []
    for recording in findings.case.recordings:
        ripple = find_fine_ripple(recording, findings.case.seed)
        if ripple is None or not is_beyond_the_base(recording, ripple, findings.base, findings.case.seed):
            return []
        found.append(ripple)
    return found


def _is_lawless(findings: Findings) -> bool:
    largest = max(float(np.std(one.torque)) for one in findings.case.recordings)
    return findings.rmse_refitted > LOOK.no_motion_law * largest
