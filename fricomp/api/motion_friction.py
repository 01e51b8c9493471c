"""Friction from a recording of any motion, together with the rigid body that it moves."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.calibration import IdentificationOptions
from fricomp.calibration.identification import IdentificationResult
from fricomp.calibration.motion.cutoffs import choose_samples
from fricomp.calibration.motion.identify import MotionIdentification
from fricomp.calibration.motion.joint_samples import RegressionSettings, split_for
from fricomp.calibration.motion.missed_torque import find_missed_gravity
from fricomp.calibration.motion.parts import read_motion_recording
from fricomp.errors import IdentificationError
from fricomp.model import JointDynamics
from fricomp.recording import Recording
from fricomp.recording.metadata import RecordingMetadata, list_dates

from .identification import Identification
from .identify_settings import IdentifySettings
from .motion_doubt import (
    doubt_for_all,
    doubt_for_degrees,
    doubt_for_step,
    fit_gravity_where_it_shows,
    tell_what_else_acts,
)
from .motion_law import identify_with_law

_AT_ZERO = 1e-4
"""Part of the largest torque, at the fastest speed, below which a viscous coefficient has run to zero."""
_MASS = {"N·m": "kg·m²", "N": "kg"}
"""Unit of the inertia beside that of the torque."""


def identify_recording(
    source: Recording | str | os.PathLike[str], settings: IdentifySettings, flag: str
) -> Identification:
    """Identify inertia, gravity, offset and friction together.

    Args:
        source: A recording, or its file.
        settings: How; what is for tables alone must be as it is.
        flag: What stands before the name of an argument in messages.

    Raises:
        IdentificationError: The motion does not suffice, or a setting is for tables.
        RecordingError: The file cannot be read, or the recording cannot be used as it is.
    """
    name = "the data" if isinstance(source, Recording) else Path(source).name
    _refuse_point_settings(name, settings, flag)
    recording, findings, about, data = read_motion_recording(source)
    chosen, samples = choose_samples(recording, gravity=bool(settings.gravity))
    notes: list[str] = []
    if chosen.torque_cutoff < RegressionSettings.torque_cutoff:
        notes.append(f"Low-pass: {chosen.torque_cutoff:.3g} Hz, so that noise of the position is no acceleration.")
    of_gaps = split_for(recording, chosen).notes
    notes += (*about, *of_gaps)
    notes += (finding.caution for finding in findings if not (of_gaps and finding.code == "gap"))
    meta = recording.metadata
    options = IdentificationOptions(joint=meta.joint, motion=meta.motion, torque_unit=meta.torque_unit)
    one_way = any(finding.code in ("one_way", "one_way_turns") for finding in findings)
    missed = find_missed_gravity(samples, chosen) if meta.motion == "rotary" and not one_way else None
    if meta.motion == "rotary" and not one_way and settings.gravity is None:
        chosen, of_gravity = fit_gravity_where_it_shows(samples, chosen, missed, meta.torque_unit, flag)
        notes += of_gravity
    motion, said = identify_with_law(samples, chosen, settings.law, options, one_way=one_way)
    if not one_way:
        motion = doubt_for_all(motion, samples, chosen, missed if settings.gravity is False else None, flag)
        notes += tell_what_else_acts(motion, samples)
        motion = doubt_for_step(doubt_for_degrees(motion, findings), findings)
    notes = [_rigid_sentence(motion, flag), *said, *notes, *_bound_notes(motion.friction)]
    result = _with_date(motion.friction if one_way else _with_rigid_body(motion), recording.metadata)
    return Identification(result, motion, None, tuple(notes), settings.to_facts(name), data)


def _with_rigid_body(motion: MotionIdentification) -> IdentificationResult:
    """The friction with what moves beside it in its model, where the motion determines the inertia: that can be
    evaluated by itself.
    """
    body, result = motion.rigid_body, motion.friction
    if body.inertia < 2.0 * body.standard_deviations[0] or body.inertia <= 0.0:
        return result
    dynamics = JointDynamics(body.inertia, *body.gravity, offset=body.offset, torque_delay=motion.lag.value)
    return replace(result, model=replace(result.model, dynamics=dynamics))


def _with_date(result: IdentificationResult, facts: RecordingMetadata) -> IdentificationResult:
    """The result with when its recording was taken in its model, where that is known."""
    made = result.model.provenance
    made = replace(made, notes={**made.notes, **list_dates([facts])})
    return replace(result, model=replace(result.model, provenance=made))


def _bound_notes(result: IdentificationResult) -> list[str]:
    """What to know of parameters that ended at their bound, which is zero: they were not measured."""
    points = result.observations
    least = _AT_ZERO * points.torque_scale / float(points.speed.max())
    names = [name for name, value in result.parameters.items() if name.endswith("viscous_coefficient")]
    at_bound = [name for name in names if result.parameters[name] < least]
    if not at_bound:
        return []
    return [
        f"Careful: {', '.join(at_bound)} is at the bound, zero, and no measured value: friction does not grow with "
        "speed here, or the motion does not tell it from the rest."
    ]


def _refuse_point_settings(name: str, settings: IdentifySettings, flag: str) -> None:
    """A recording is identified by filtered regression, which these settings do not reach."""
    plain = IdentifySettings()
    changed = [
        f"{flag}{one}"
        for one in ("method", "noise", "loss", "seed", "depart")
        if not np.array_equal(getattr(settings, one), getattr(plain, one))
    ]
    changed += [f"{flag}law auto"] if settings.law == "auto" else []
    if changed:
        raise IdentificationError(
            f"{', '.join(changed)} is for tables of velocity and torque; {name} is a recording, whose friction is "
            "identified together with its rigid body by filtered regression: leave "
            f"{'them' if len(changed) > 1 else 'it'} out"
        )


def _rigid_sentence(motion: MotionIdentification, flag: str) -> str:
    body, model = motion.rigid_body, motion.friction.model
    torque, angle = model.torque_unit, model.position_unit
    of_inertia, *_, of_offset = body.standard_deviations
    (cosine, sine), (of_cosine, of_sine) = body.gravity, body.gravity_deviations
    gravity = f"({cosine:.4g} ± {of_cosine:.2g}) cos q + ({sine:.4g} ± {of_sine:.2g}) sin q {torque}"
    absent = f"not fitted ({flag}gravity)"
    offset = f", offset {body.offset:.4g} ± {of_offset:.2g} {torque}" if of_offset > 0.0 else ""
    said = (
        f"Rigid body, ± its standard deviations: inertia {body.inertia:.5g} ± {of_inertia:.2g} "
        f"{_MASS.get(torque, f'{torque}·s²/{angle}')}{offset}, gravity "
        f"{gravity if any(body.gravity) else absent}; symmetric friction beside it: Coulomb "
        f"{body.coulomb_torque:.5g} {torque}, viscous {body.viscous_coefficient:.5g} {torque}·s/{angle}. "
        f"{len(motion.points)} samples slide and count; standard deviations allow for their correlation. "
        f"{motion.lag.sentence}"
    )
    if body.inertia < 2.0 * of_inertia:  # a 95 % interval that holds zero
        said += " The motion does not determine the inertia: record one with quicker accelerations while it slides."
    if motion.presliding > 0.0:
        said += (
            f" Friction builds up after rests and reversals: the first {motion.presliding:.2g} {angle} are left out."
        )
    return said
