"""The case that is judged, and how it stands to the simulation and friction that were given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..inputs.rigid import RigidJoint, Spring
from ..joint.base import BODY_AND_CURVES, unpack
from ..joint.solver import Fit
from ..search.preparation import Baseline
from ..search.search import SearchResult
from .as_given import fit_as_given
from .comparison import Comparison, Tolerances
from .friction_comparison import GivenFriction, compare_friction, list_friction_changes, would_push
from .refitted import RefittedJoint
from .rigid_comparison import compare_rigid
from .settings import GATES, PARAMETERS


@dataclass(frozen=True)
class Case:
    """Recordings of one joint, the base fitted to them, what the search found, and what it is compared with.

    Attributes:
        recordings: Of the joint, on its own side.
        baseline: The base fitted to the recordings, with its nulls.
        found: What the search found.
        rigid: Inertia, gravity and spring of the simulation; None where none was given.
        friction: Friction model that was given; None where none was.
        seed: Of bootstraps and samples; the same for every recording.
        bands: Seed of the bands of the report's maps, which decide nothing.
        instead: Effects that explain, with the simulation as given, as much as another inertia or gravity.
    """

    recordings: tuple[Recording, ...]
    baseline: Baseline
    found: SearchResult
    rigid: RigidJoint | None
    friction: FrictionModel | None
    seed: int
    bands: int = 0
    instead: tuple[str, ...] = ()

    @property
    def stated_friction(self) -> FrictionModel | None:
        """The friction model that was given, else the simulation's own friction, which both directions share.

        None where there is neither: then all of it is identified, and so is its difference between the directions, as
        long as friction alone can make it.
        """
        rigid = self.rigid
        if self.friction is not None or rigid is None or rigid.covariance is not None:
            return self.friction
        if rigid.friction_loss <= 0.0 and not would_push(unpack(self.baseline.fit.theta), rigid.offset):
            return None
        curve = StribeckCurve(rigid.friction_loss, rigid.friction_loss, PARAMETERS.any_speed, rigid.damping)
        return FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),)))

    @property
    def unit(self) -> str:
        """Unit of torque."""
        return self.recordings[0].metadata.torque_unit

    @property
    def position_unit(self) -> str:
        """Unit of position."""
        return self.recordings[0].metadata.position_unit

    @property
    def spring(self) -> Spring | None:
        """Of the simulation."""
        return None if self.rigid is None else self.rigid.spring


def compare_given(case: Case, refitted: RefittedJoint, tolerances: Tolerances) -> Comparison:
    """Compare what was refitted with the given simulation and friction.

    Args:
        case: What was given.
        refitted: The joint that the verdict is about.
        tolerances: How far its parameters stray beyond what the fit knows of its own error.
    """
    cov, plant = tolerances.known**2 * refitted.covariance[:BODY_AND_CURVES, :BODY_AND_CURVES], refitted.plant
    result, given = Comparison(), case.rigid
    turning = given if given is not None and given.rotary else None
    read = given is not None and given.covariance is not None  # from a recording of the simulation, friction and all
    if given is not None and given.covariance is not None:
        cov = cov + given.covariance
    acceleration = compute_rms(np.concatenate([c.acceleration for c in refitted.structure.contexts]))
    if given is not None:
        material = GATES.material if case.baseline.nulls.quiet else GATES.least
        result = compare_rigid(plant, cov[:4, :4], given, case.unit, tolerances, acceleration, material=material)
    if given is not None and (read or case.friction is None):
        units = (case.unit, case.position_unit)
        result = replace(result, changes=result.changes + list_friction_changes(plant, cov, given, units, tolerances))
    stated = case.stated_friction
    if stated is None:
        return result
    held, offset = None if result.shifts else turning, 0.0 if given is None else given.offset
    beside = GivenFriction(stated, offset, held, exact=case.friction is not None)
    more = compare_friction(plant, cov, beside, case.unit, tolerances, acceleration)
    return Comparison(result.shifts + more.shifts, result.changes + more.changes)


def fit_given(case: Case, names: Sequence[str]) -> Fit | None:
    """Fit the base with the parameters of these effects as given; None where none of them was given."""
    return fit_as_given(case.baseline, names, case.rigid, case.stated_friction)


def share_between(case: Case, names: Sequence[str]) -> tuple[float, ...]:
    """Part that each of several moved parameters has in what putting all of them right explains. They sum to 1."""
    if len(names) == 1:
        return (1.0,)
    alone = [fit_given(case, [one]) for one in names]
    costs = [1e-30 if one is None else max(one.cost - case.baseline.fit.cost, 1e-30) for one in alone]
    return tuple(cost / sum(costs) for cost in costs)
