"""A second look where no physics was named that covers the mismatch: soft presliding, fine ripple, a late drive."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.recording import Recording

from ..record.result import Diagnosis, HeldOut
from .drive_path import find_drive_path
from .fine_ripple import FineRipple, Harmonic, find_fine_ripple
from .proving import beyond_the_base, softer_than_the_base
from .second_answer import searched, with_drive_path, with_presliding, with_ripple
from .soft_presliding import SoftPresliding, find_soft_presliding

__all__ = ["second_look"]

_COVERED = 0.7  # of the explainable energy; what was named with more than that stands
_NO_MOTION_LAW = (
    0.5  # of the torque's standard deviation; a joint whose base leaves more obeys no law of its own motion
)
_OTHER_ORDER = 1.5  # ratio of orders from which two ripples are not the same one
_RIPPLES = ("cogging", "position_coulomb")
_LARGER = 2.0  # ratio of amplitudes from which the finer ripple is the one to name


def second_look(recordings: Sequence[Recording], diagnosis: Diagnosis, seed: int = 0) -> Diagnosis:
    """The diagnosis, or a better founded one.

    Args:
        recordings: The recordings, in the order of the diagnosis.
        diagnosis: What the search over the catalogue concluded.
        seed: Of samples and bootstraps.
    """
    held = diagnosis.heldout
    if held is None or diagnosis.detent_order is not None:  # one unknown part shows as a ripple in the samples too
        return diagnosis
    path = find_drive_path(recordings[0]) if _lawless(recordings, held) else None
    if path is not None:
        return with_drive_path(recordings, diagnosis, path, seed)
    coarse = _ripple_of(diagnosis)
    if _stands(diagnosis) and coarse is None:
        return diagnosis
    soft = [] if _settled(diagnosis) else _soft_presliding(recordings, diagnosis, seed)
    if soft:
        return with_presliding(recordings, diagnosis, soft, seed)
    found = _fine_ripples(recordings, diagnosis, seed)
    if not found or (coarse is not None and not _finer(found[0].harmonics[0], coarse)):
        return diagnosis
    return with_ripple(recordings, diagnosis, found, seed)


def _stands(diagnosis: Diagnosis) -> bool:
    """Whether the search named something that takes the mismatch away on held-out data, of whatever kind."""
    return searched(diagnosis) and diagnosis.heldout is not None and diagnosis.heldout.explained >= _COVERED


def _settled(diagnosis: Diagnosis) -> bool:
    """Whether nothing is left for a softer bristle: a base at its noise has one of its own, whatever the comparison
    with the simulation says about its parameters."""
    return _stands(diagnosis) or (diagnosis.verdict != "unknown_physics" and not searched(diagnosis))


def _soft_presliding(recordings: Sequence[Recording], diagnosis: Diagnosis, seed: int) -> list[SoftPresliding]:
    """The bristle of each recording, where the base alone would show none; empty where one of them has none."""
    found = []
    for recording in recordings:
        soft = find_soft_presliding(recording)
        if soft is None or not softer_than_the_base(recording, diagnosis.record.base, seed):
            return []
        found.append(soft)
    return found


def _fine_ripples(recordings: Sequence[Recording], diagnosis: Diagnosis, seed: int) -> list[FineRipple]:
    """The ripple of each recording, where it is more than the base alone would show; empty where one has none."""
    found = []
    for recording in recordings:
        ripple = find_fine_ripple(recording, seed)
        if ripple is None or not beyond_the_base(recording, ripple, diagnosis.record.base, seed):
            return []
        found.append(ripple)
    return found


def _ripple_of(diagnosis: Diagnosis) -> tuple[float, float] | None:
    """Order and amplitude of the ripple that was named, of torque or of friction; None where none was."""
    for effect in diagnosis.effects:
        values = {name: one.value for name, one in effect.parameters.items()}
        if effect.name in _RIPPLES and {"order", "sine", "cosine"} <= set(values):
            return values["order"], float(np.hypot(values["sine"], values["cosine"]))
    return None


def _finer(harmonic: Harmonic, coarse: tuple[float, float]) -> bool:
    """Whether a ripple of the samples is another and larger one than that of the rows."""
    order, amplitude = coarse
    return harmonic.order > _OTHER_ORDER * order and harmonic.amplitude > _LARGER * amplitude


def _lawless(recordings: Sequence[Recording], held: HeldOut) -> bool:
    return held.rmse_refitted > _NO_MOTION_LAW * max(float(np.std(one.torque)) for one in recordings)
