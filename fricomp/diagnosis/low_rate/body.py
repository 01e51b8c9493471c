"""Inertia and gravity beside the simulation's at low rates, by the names of the catalogue."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.evaluation import RecordedMotion

from ..delivery.models import GivenModel
from ..evidence.comparison import Comparison, Tolerances
from ..evidence.rigid_comparison import compare_rigid
from ..evidence.settings import PARAMETERS
from ..inputs.rigid import RigidJoint
from ..joint.observer import Plant
from .held_out import Fitted, fit_held_out, is_better, measure_acceleration, measure_level, read_number
from .models import replace_gravity
from .settings import LOW_RATE

_NUMBERS = ("inertia", "gravity_cosine", "gravity_sine", "offset")
_STRAYS = Tolerances(
    inertia=LOW_RATE.form,
    accelerating=0.5 * LOW_RATE.of_friction,
    gravity=LOW_RATE.form,
    sliding=0.5 * LOW_RATE.of_friction,
    uneven=0.5 * LOW_RATE.of_friction,
)
"""Numbers of plain joints stray by a part of their size and by a part of the friction; what effects have to exceed is
twice that."""


def compare_body(rigid: RigidJoint, given: Fitted, fit: Fitted, motion: RecordedMotion) -> Comparison:
    """What of the simulation's body is off by more than the recording leaves open and than is told at such rates.

    Where data left out say that it is off, its numbers need less to be told: four folds know little of how they stray.

    Args:
        rigid: The simulation.
        given: With its body.
        fit: With all that was named.
        motion: What it was fitted to.
    """
    inertia, cosine, sine, offset = (read_number(fit.model, name) for name in _NUMBERS)
    level = measure_level(fit, motion)
    curve = (level, level, 1.0, 0.0)
    plant = Plant(inertia, (cosine, sine), offset, curve, curve, sigma_0=1.0)
    strays = np.array([LOW_RATE.certain / 1.96 * fit.deviation(name) for name in _NUMBERS])
    covariance = np.diag((strays / np.array([inertia, 1.0, 1.0, 1.0])) ** 2)
    is_shown = is_better(given, fit, LOW_RATE.search_matters)
    least = PARAMETERS.shown if is_shown else PARAMETERS.significant
    found = compare_rigid(plant, covariance, rigid, motion.torque_unit, _STRAYS, measure_acceleration(motion), least)
    moved = {one.name: abs(one.refitted.value - one.given) for one in found.changes}
    gravity = float(
        np.hypot(moved.get("gravity_cos", 0.0), moved.get("gravity_sin", 0.0))
    )  # one angle's is the other's
    parts = {
        "inertia": moved.get("inertia", 0.0) / rigid.inertia,
        "weight": moved.get("weight", 0.0) / max(abs(rigid.offset), level),
        "gravity": gravity / max(float(np.hypot(*rigid.gravity)), level),
    }
    told = [
        one
        for one in found.changes
        if parts[one.name.split("_")[0]] > LOW_RATE.matters_given
        and not one.refitted.ci95[0] <= one.given <= one.refitted.ci95[1]
    ]
    return Comparison(found.shifts, tuple(told)) if told else Comparison()


def put_back(rigid: RigidJoint, fit: Fitted) -> GivenModel:
    """The joint with the simulation's body: its error is that before the answer."""
    model = replace_gravity(fit.model, rigid)
    assert model.dynamics is not None
    body = replace(model.dynamics, inertia=rigid.inertia, load_inertia=0.0)
    return GivenModel(replace(model, dynamics=body), (*fit.held, *_NUMBERS[:3]))


def fit_as_given(rigid: RigidJoint, fit: Fitted, motion: RecordedMotion) -> Fitted:
    """The joint with the simulation's body, all else refitted."""
    given = put_back(rigid, fit)
    return fit_held_out(given.model, motion, given.held)
