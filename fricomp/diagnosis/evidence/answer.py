"""What a verdict is drawn from, and how it stands to the simulation and friction that were given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec.structs import replace as with_fields

from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from ..inputs.rigid import RigidJoint, Spring
from ..joint.base import BODY_AND_CURVES
from ..joint.solver import Fit
from ..record.result import Location, NamedEffect, RowSeries
from ..search.preparation import Baseline
from ..search.search import SearchResult
from .as_given import fit_as_given
from .comparison import Comparison, Doubt
from .friction_comparison import GivenFriction, compare_friction, friction_changes
from .location import locate
from .refitted import Refitted
from .rigid_comparison import compare_rigid

__all__ = ["Answer", "compare_given", "fit_given", "moved_parameters"]


_ANY_SPEED = 1.0  # [rad/s] or [m/s], Stribeck velocity of a friction that does not fall with speed


@dataclass(frozen=True)
class Answer:
    """Everything a verdict is drawn from.

    Attributes:
        instead: Effects that explain, with the simulation as given, as much as another inertia or gravity.
    """

    recordings: tuple[Recording, ...]
    prepared: Baseline
    found: SearchResult
    rigid: RigidJoint | None
    friction: FrictionModel | None
    seed: int
    instead: tuple[str, ...] = ()

    @property
    def stated_friction(self) -> FrictionModel | None:
        """The friction model that was given, else the simulation's own friction, which both directions share.

        None where there is neither: then all of it is identified, and so is its difference between the directions.
        """
        rigid = self.rigid
        if self.friction is not None or rigid is None or rigid.covariance is not None or rigid.friction_loss <= 0.0:
            return self.friction
        curve = StribeckCurve(rigid.friction_loss, rigid.friction_loss, _ANY_SPEED, rigid.damping)
        return FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),)))

    @property
    def unit(self) -> str:
        """Unit of torque."""
        return self.recordings[0].metadata.torque_unit

    @property
    def spring(self) -> Spring | None:
        """Of the simulation."""
        return None if self.rigid is None else self.rigid.spring

    @property
    def position_unit(self) -> str:
        """Unit of position."""
        return self.recordings[0].metadata.position_unit


def compare_given(answer: Answer, refitted: Refitted, doubt: Doubt) -> Comparison:
    """What the refit moved of the given simulation and friction."""
    cov, plant = doubt.known**2 * refitted.covariance[:BODY_AND_CURVES, :BODY_AND_CURVES], refitted.plant
    result = Comparison()
    rigid = answer.rigid if answer.rigid is not None and answer.rigid.rotary else None
    if answer.rigid is not None and answer.rigid.covariance is not None:
        cov = cov + answer.rigid.covariance
    acceleration = float(np.sqrt(np.mean(np.concatenate([c.acceleration for c in refitted.structure.contexts]) ** 2)))
    if rigid is not None:
        result = compare_rigid(plant, cov[:3, :3], rigid, answer.unit, doubt, acceleration)
    read = answer.rigid is not None and answer.rigid.covariance is not None  # its friction with it
    if answer.rigid is not None and (read or answer.friction is None):
        units = (answer.unit, answer.position_unit)
        result = replace(result, changes=result.changes + friction_changes(plant, cov, answer.rigid, units, doubt))
    stated = answer.stated_friction
    if stated is not None:
        held, offset = None if result.effects else rigid, 0.0 if answer.rigid is None else answer.rigid.offset
        given = GivenFriction(stated, offset, held, exact=answer.friction is not None)
        more = compare_friction(plant, cov, given, answer.unit, doubt, acceleration)
        return Comparison(result.effects + more.effects, result.changes + more.changes)
    return result


def fit_given(answer: Answer, effects: Sequence[NamedEffect]) -> Fit | None:
    """The base with the parameters of these effects as given; None where none of them was."""
    return fit_as_given(answer.prepared, [one.name for one in effects], answer.rigid, answer.stated_friction)


def moved_parameters(
    answer: Answer, effects: Sequence[NamedEffect], explained: float, series: tuple[RowSeries, ...]
) -> tuple[list[NamedEffect], Location]:
    """Parameters that are off, with their shares of what putting them right explains, and where it shows."""
    energy = [np.maximum(one.before**2 - one.after**2, 0.0) / one.spread**2 for one in series]
    location = locate(series, energy, rows=5)
    parts = [1.0]
    if len(effects) > 1:
        alone = [fit_given(answer, [one]) for one in effects]
        parts = [1e-30 if one is None else max(one.cost - answer.prepared.fit.cost, 1e-30) for one in alone]
    return [
        with_fields(one, share=explained * part / sum(parts), location=location)
        for one, part in zip(effects, parts, strict=True)
    ], location
