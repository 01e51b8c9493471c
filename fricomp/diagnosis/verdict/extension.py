"""The refitted base and the extended model as friction models that compensate and export like any other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from fricomp.laws import BidirectionalStribeck, FrictionLaw, LaggedLuGre, LaggedStribeck, LuGre, StribeckCurve, Term
from fricomp.model import FrictionModel, JointDynamics, Provenance, Validity
from fricomp.model.plausibility import find_impossible
from fricomp.recording import Recording
from fricomp.recording.metadata import list_dates

from ..effects import Context
from ..effects.spring import SPRING, combine_springs
from ..effects.structure import N_BASE
from ..evidence.refitted import RefittedJoint
from ..inputs.rigid import Spring
from ..inputs.track import FloatArray
from ..joint.observer import Contribution, Plant
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from .settings import VERDICT

_OF_THE_CORE = ("stribeck_exponent", "sigma_0", "sigma_1", "lag")  # fields of a plant that its curves and bristle have


def write_base_model(
    recordings: Sequence[Recording], joint: Baseline | RefittedJoint, *, cancels: bool = False
) -> FrictionModel:
    """Friction and rigid body of a joint without its effects; `cancels` says whether its constant torque may all be
    gravity."""
    plant = joint.structure.unpack_plant(joint.fit.theta)
    shared = _share_offset(plant, cancels=cancels)
    terms = (BidirectionalStribeck(*_build_pair(shared, VERDICT.exponent)),)
    dynamics = _describe_dynamics(shared, late=-joint.structure.contexts[0].acts_late)
    return _write_model(recordings, joint.structure.contexts, terms, dynamics, plant.offset)


def write_extended_model(
    recordings: Sequence[Recording],
    chosen: Explanation | RefittedJoint | None,
    given: Spring | None = None,
    *,
    cancels: bool = False,
) -> FrictionModel | None:
    """Friction with the named effects, refitted together; None where no effect belongs to a friction law.

    A spring that was named beside the one `given` in the simulation is in it as a whole, in place of that one.
    """
    if chosen is None:
        return None
    values = chosen.structure.name_values(chosen.fit.theta[N_BASE:])
    plant = chosen.structure.unpack_plant(chosen.fit.theta)
    terms: list[Term] = []
    changes: dict[str, float] = {}
    candidates = chosen.structure.candidates
    for candidate in candidates:
        contribution = candidate.effect.compute_contribution(chosen.structure.contexts[0], values[candidate.name])
        changes |= {name: value for name, value in contribution.plant.items() if name in _OF_THE_CORE}
        if candidate.name == SPRING and given is not None:
            term, plant = combine_springs(values[candidate.name], plant, given)
            terms += [] if term is None else [term]
        else:
            terms += candidate.effect.build_terms(values[candidate.name], plant, chosen.structure.contexts)
    if not terms and not changes:
        return None
    shares = [one["inertia_share"] for one in values.values() if "inertia_share" in one]
    late = sum(
        (one.effect.compute_contribution(chosen.structure.contexts[0], values[one.name]) for one in candidates),
        Contribution(),
    )
    added = late.delay + sum(late.lags).real - chosen.structure.contexts[0].acts_late
    shared = _share_offset(plant, cancels=cancels)
    dynamics = _describe_dynamics(shared, max(shares, default=0.0), added)
    core = _build_core(shared, changes)
    return _write_model(recordings, chosen.structure.contexts, (core, *terms), dynamics, plant.offset)


def _describe_dynamics(plant: Plant, load_share: float = 0.0, late: float = 0.0) -> JointDynamics:
    """What moves with the joint beside its friction.

    Args:
        plant: The joint.
        load_share: Part of its inertia that the gear feels as load [1].
        late: Time by which effects make the torque late, beside the joint's own delay [s]. A low-pass counts as its
            time constant, by which it is late in the mean; a torque that acts after its stamp counts as early.
    """
    return JointDynamics(
        inertia=plant.inertia,
        gravity_cosine=plant.gravity[0],
        gravity_sine=plant.gravity[1],
        offset=plant.offset,
        load_inertia=load_share * plant.inertia,
        torque_delay=plant.delay + late,
    )


def _build_core(plant: Plant, changes: Mapping[str, float]) -> Term:
    """The friction curves, with the exponent, bristle and lag that effects gave them."""
    forward, reverse = _build_pair(plant, changes.get("stribeck_exponent", VERDICT.exponent))
    lag = changes.get("lag", 0.0)
    if "sigma_0" in changes:
        sigma_0, sigma_1 = changes["sigma_0"], changes.get("sigma_1", 0.0)
        if lag > 0.0:
            return LaggedLuGre(forward, reverse, sigma_0, sigma_1, lag=lag)
        return LuGre(forward, reverse, sigma_0, sigma_1)
    if lag > 0.0:
        return LaggedStribeck(forward, reverse, lag=lag)
    return BidirectionalStribeck(forward, reverse)


def _build_pair(plant: Plant, exponent: float) -> tuple[StribeckCurve, StribeckCurve]:
    """The curves of both directions."""
    forward, reverse = (StribeckCurve(*curve, exponent) for curve in (plant.forward, plant.reverse))
    return forward, reverse


def _share_offset(plant: Plant, *, cancels: bool) -> Plant:
    """The joint with its constant torque in the curves of both directions, where they hold it without driving it.

    While the joint slides it cannot be told from a difference between the directions, and nothing else of the model
    would make it: friction and rigid body together are to give the recorded torque. One that cancels with gravity, as
    over a small angle, stays beside that.
    """
    shift = plant.offset
    if cancels or abs(shift) >= min(plant.forward[0], plant.reverse[0]):
        return plant
    forward, reverse = (
        (c + sign * shift, s + sign * shift, v, f)
        for (c, s, v, f), sign in ((plant.forward, 1.0), (plant.reverse, -1.0))
    )
    return replace(plant, offset=0.0, forward=forward, reverse=reverse)


def _write_model(
    recordings: Sequence[Recording],
    contexts: Sequence[Context],
    terms: tuple[Term, ...],
    dynamics: JointDynamics,
    offset: float,
) -> FrictionModel:
    metadata = recordings[0].metadata
    where = "in the dynamics of this model" if dynamics.offset else "in the forward curve, less it in the reverse curve"
    said = f"{offset:.4g} {metadata.torque_unit} {where}"
    law, speeds = FrictionLaw(terms), np.concatenate([context.velocity for context in contexts])
    warm = all("temperature" in context.channels for context in contexts)
    model = FrictionModel(
        law=law,
        joint=metadata.joint,
        motion=metadata.motion,
        torque_unit=metadata.torque_unit,
        validity=Validity(
            velocity=_find_range(context.velocity for context in contexts),
            position=_find_range(np.asarray(recording.position) for recording in recordings),
            load_torque=_find_range(context.load_torque for context in contexts),
            acceleration=_find_range(context.acceleration for context in contexts),
            temperature=_find_range(context.channels["temperature"] for context in contexts) if warm else None,
        ),
        provenance=Provenance(
            method="diagnosis",
            data_sha256=recordings[0].content_hash,
            notes={"torque_offset": said, **list_dates(one.metadata for one in recordings)},
        ),
        dynamics=dynamics if metadata.motion == "rotary" else replace(dynamics, gravity_cosine=0.0, gravity_sine=0.0),
    )
    reason = find_impossible(replace(model, law=FrictionLaw(terms[:1])), speeds)
    if reason is None:
        return model
    return replace(model, provenance=replace(model.provenance, status="not_identifiable", message=reason))


def _find_range(columns: Iterable[FloatArray]) -> tuple[float, float]:
    """Lowest and highest value over all recordings."""
    ends = [(float(np.min(column)), float(np.max(column))) for column in columns]
    return min(low for low, _ in ends), max(high for _, high in ends)
