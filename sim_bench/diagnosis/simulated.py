"""The user's own simulation, known only by a recording that it made under the same commands."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace as with_fields

from fricomp.errors import DiagnosisError
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .base import BASE_NAMES
from .comparison import SPLIT
from .diagnose import diagnose
from .result import Diagnosis
from .rigid import RigidJoint
from .sentence import sentences
from .track import FloatArray

__all__ = ["SimulatedJoint", "motion_remarks", "read_simulated", "without_known"]

_SHORT = 0.8  # of the recording's duration, below which a simulated one is told to be shorter
# Unrelated motions of one size differ by the square root of two, in standard deviations of the position; the same one
# by how differently two joints follow a command.
_SAME_MOTION = 0.5
# How an offset and the difference of the directions make up for each other while the joint slides.
_PARTING = {"offset": 1.0, "forward.coulomb_torque": -1.0, "reverse.coulomb_torque": 1.0}


@dataclass(frozen=True)
class SimulatedJoint:
    """What a simulation's recording says about the simulation.

    Attributes:
        rigid: Its inertia and gravity.
        friction: Its friction.
        effects: Effects of the catalogue that it has itself.
    """

    rigid: RigidJoint
    friction: FrictionModel | None
    effects: tuple[str, ...]


def read_simulated(
    recording: Recording, *, seed: int = 0, progress: Callable[[str], None] | None = None
) -> SimulatedJoint:
    """Identify the joint that a simulation has, from its own recording, in the way of any other recording.

    Raises:
        DiagnosisError: No joint can be identified from it.
    """
    found = diagnose(recording, seed=seed, progress=progress)
    if found.verdict == "bad_data":
        raise DiagnosisError(f"the simulated recording cannot be used: {' '.join(found.sentences[1:])}")
    base = found.record.base
    if not base:
        raise DiagnosisError(
            "the simulated recording obeys no law of its joint's own motion, so no simulation can be read from it: "
            "give one that moves freely, or the simulation itself with --simulation"
        )
    if found.verdict == "unknown_physics":
        raise DiagnosisError(
            f"the simulated recording shows something that no effect explains ({found.record.noise_ratio:.3g} times "
            "its noise is left), so its inertia, gravity and friction cannot be read off it: give the simulation "
            "itself with --simulation"
        )
    level = 0.5 * (base["forward.coulomb_torque"].value + base["reverse.coulomb_torque"].value)
    rigid = RigidJoint(
        inertia=base["inertia"].value,
        gravity=(base["gravity_cos"].value, base["gravity_sin"].value),
        offset=base["offset"].value,
        damping=0.0,
        friction_loss=0.0,
        rotary=recording.metadata.motion == "rotary",
        covariance=None if found.covariance is None else _body_and_curves(found.covariance, level),
    )
    return SimulatedJoint(rigid, found.base_model, tuple(effect.name for effect in found.effects))


def _body_and_curves(covariance: FloatArray, level: float) -> FloatArray:
    """Covariance of inertia, gravity, offset and curves; what sliding cannot part is known no better than in a refit.

    Args:
        covariance: Of the base. Shape (p, p).
        level: Coulomb torque.
    """
    named = BASE_NAMES[: BASE_NAMES.index("log_breakaway")]
    parting = np.array([_PARTING.get(name, 0.0) for name in named]) * SPLIT * level
    result: FloatArray = covariance[: len(named), : len(named)] + np.outer(parting, parting)
    return result


def without_known(diagnosis: Diagnosis, simulated: SimulatedJoint) -> Diagnosis:
    """The diagnosis without the effects that the simulation has itself."""
    record = diagnosis.record
    kept = tuple(effect for effect in record.effects if effect.name not in simulated.effects)
    if len(kept) == len(record.effects):
        return diagnosis
    shared = ", ".join(effect.name for effect in record.effects if effect.name in simulated.effects)
    kinds = {effect.kind for effect in kept}
    by_kind = (("physics", "missing_physics"), ("measurement", "measurement"), ("parameter", "parameters"))
    verdict = next((verdict for kind, verdict in by_kind if kind in kinds), "consistent")
    record = with_fields(record, effects=kept, verdict=verdict)
    told = (*sentences(record), f"The simulation shows {shared} as well, so this is not missing in it.")
    return Diagnosis(
        with_fields(record, sentences=told),
        diagnosis.evidence,
        diagnosis.base_model,
        diagnosis.extended_model,
        diagnosis.motion,
    )


def motion_remarks(recordings: Sequence[Recording], simulated: Recording) -> tuple[str, ...]:
    """What tells that a simulated recording was not made under the commands of the recordings, in sentences."""
    longest = max(one.duration for one in recordings)
    if simulated.duration < _SHORT * longest:
        return (
            f"The simulated recording lasts {simulated.duration:.3g} s and the recording {longest:.3g} s: what it says "
            "about the simulation holds for the part of the motion that it has.",
        )
    apart = min(_apart(one, simulated) for one in recordings)
    if apart < _SAME_MOTION:
        return ()
    return (
        f"The simulated recording has another motion (positions at the same times differ by {apart:.2g} times the "
        "spread of the recorded ones): let the simulator follow the same commands, since a motion that shows less of "
        "its joint leaves the comparison in doubt.",
    )


def _apart(recording: Recording, simulated: Recording) -> float:
    """RMS difference of the positions at the same time since the start, over the standard deviation of the recorded."""
    time = np.asarray(recording.time) - recording.time[0]
    shared = time <= simulated.duration
    moved = np.interp(time[shared], np.asarray(simulated.time) - simulated.time[0], np.asarray(simulated.position))
    position = np.asarray(recording.position)[shared]
    return float(np.sqrt(np.mean((moved - position) ** 2)) / max(float(np.std(position)), 1e-12))
