"""The models that are compared at low rates: the plain joint, and one with each effect that sliding shows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.evaluation import RecordedMotion
from fricomp.laws import (
    COGGING_TERMS,
    POSITION_COULOMB_TERMS,
    Cogging,
    Coulomb,
    EndStop,
    FrictionLaw,
    LoadCoulomb,
    LoadQuadratic,
    PositionCoulomb,
    QuadraticDrag,
    SpringTorque,
    Stribeck,
    StribeckCurve,
    Term,
    Viscous,
)
from fricomp.model import FrictionModel, JointDynamics, Provenance, Validity
from fricomp.recording import Recording
from fricomp.recording.metadata import list_dates
from fricomp.root_mean_square import compute_rms

from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray
from .held_out import Fitted, measure_level
from .settings import LOW_RATE


@dataclass(frozen=True)
class Candidate:
    """An effect to try.

    Attributes:
        name: In the catalogue.
        model: To start the fit from.
        numbers: Its own numbers: names in the model.
        matters: Part of the held-out energy that it has to take.
        held: Numbers of the model that stay as they are.
        alike: Names of other effects that leave as little.
        shown: Part of its torque that the plain joint cannot make up for.
    """

    name: str
    model: FrictionModel
    numbers: tuple[str, ...]
    matters: float
    held: tuple[str, ...] = ()
    alike: tuple[str, ...] = ()
    shown: float = 1.0


def write_plain_model(recordings: Sequence[Recording], motion: RecordedMotion) -> FrictionModel:
    """Coulomb and viscous friction with inertia, gravity and offset, to start fits from."""
    torque, speed = (np.concatenate([getattr(part, name)[part.moves] for part in motion.parts]) for name in _COLUMNS)
    change = np.concatenate([part.acceleration[part.moves] for part in motion.parts])
    size = compute_rms(torque)
    metadata = recordings[0].metadata
    positions = [np.asarray(one.position) for one in recordings]
    return FrictionModel(
        law=FrictionLaw((Coulomb(0.5 * size), Viscous(0.1 * size / max(float(np.std(speed)), 1e-12)))),
        joint=metadata.joint,
        motion=metadata.motion,
        torque_unit=metadata.torque_unit,
        validity=Validity(
            velocity=(float(speed.min()), float(speed.max())),
            position=(min(float(one.min()) for one in positions), max(float(one.max()) for one in positions)),
            acceleration=(float(change.min()), float(change.max())),
        ),
        provenance=Provenance(
            method="diagnosis",
            data_sha256=recordings[0].content_hash,
            notes=list_dates(one.metadata for one in recordings),
        ),
        dynamics=JointDynamics(
            inertia=0.1 * size / max(float(np.std(change)), 1e-12),
            gravity_cosine=0.0,
            gravity_sine=0.0,
            offset=0.0,
            load_inertia=0.0,
            torque_delay=0.0,
        ),
    )


_COLUMNS = ("torque", "smooth_velocity")


def list_candidates(base: Fitted, motion: RecordedMotion, period: float, *, may_be_late: bool) -> Iterator[Candidate]:
    """Effects that can be tried beside what a fit has.

    Args:
        base: The fit so far.
        motion: What it was fitted to.
        period: Of the samples [s].
        may_be_late: Whether delays are tried.
    """
    for one in _list_laws(base, motion):
        yield replace(one, held=tuple(dict.fromkeys((*base.held, *one.held))))
    for delay in LOW_RATE.delays if may_be_late else ():
        late = replace_delay(base.model, delay * period)
        yield Candidate("torque_delay", late, ("torque_delay",), LOW_RATE.matters, base.held)


def _list_laws(base: Fitted, motion: RecordedMotion) -> Iterator[Candidate]:
    """Terms that the law of a fit may lack, each where the motion can show it."""
    has, rows = {term.name for term in base.model.law.terms}, _Rows.gather(base, motion)
    load = _measure_load(base.model, motion)
    if not has & {LoadCoulomb.name, LoadQuadratic.name} and load > LOW_RATE.load_matters * measure_level(base, motion):
        for loaded in (LoadCoulomb(0.05), LoadQuadratic(0.05 / load)):
            own = (f"{loaded.name}.coefficient",)
            yield Candidate(loaded.name, _add(base.model, loaded), own, LOW_RATE.matters)
    for term in (COGGING_TERMS[0], POSITION_COULOMB_TERMS[0]):
        wave = None if term.name in has else _find_wave(rows, motion, term)
        if wave is not None:
            numbers = tuple(f"{term.name}.{name}" for name in ("sine", "cosine", "order"))
            yield Candidate(term.name, _add(base.model, wave), numbers, LOW_RATE.search_matters)
    if "quadratic_drag" not in has:
        yield add_drag(base, motion)
    if "spring_torque" not in has:
        yield add_spring(base, motion)
    stop = None if "end_stop" in has else _find_stop(rows)
    if stop is not None:
        held = ("end_stop.damping", "end_stop.travel", "end_stop.hardening")
        edge = ("end_stop.stiffness", "end_stop.edge")
        yield Candidate("end_stop", _add(base.model, stop), edge, LOW_RATE.search_matters, held)


def add_drag(base: Fitted, motion: RecordedMotion) -> Candidate:
    """Drag, most of which viscous and Coulomb friction make up for."""
    drag = QuadraticDrag(base.rms / max(float(np.mean(_Rows.gather(base, motion).velocity ** 2)), 1e-12))
    numbers = ("quadratic_drag.coefficient",)
    return Candidate("quadratic_drag", _add(base.model, drag), numbers, LOW_RATE.matters, shown=LOW_RATE.drag_shown)


def add_spring(base: Fitted, motion: RecordedMotion) -> Candidate:
    """A spring at rest in the middle: where it is at rest and an offset are one."""
    rows = _Rows.gather(base, motion)
    start = SpringTorque(base.rms / max(float(np.std(rows.position)), 1e-12), float(np.mean(rows.position)))
    held = (*base.held, "spring_torque.centre", "spring_torque.hardening")
    return Candidate("spring_torque", _add(base.model, start), ("spring_torque.stiffness",), LOW_RATE.matters, held)


def bend_curve(model: FrictionModel) -> FrictionModel:
    """The plain joint with friction that falls from rest, to start a fit from."""
    assert model.validity.velocity is not None
    curve, speed = model.law.parameters(), LOW_RATE.falls_by * model.validity.velocity[1]
    coulomb, viscous = curve["coulomb.coulomb_torque"], curve["viscous.viscous_coefficient"]
    falling = StribeckCurve(coulomb, LOW_RATE.rises * coulomb, speed, viscous)
    return model.with_law(FrictionLaw((Stribeck(falling),)))


def leave_out(model: FrictionModel, name: str) -> FrictionModel:
    """The model without a term, or without a delay."""
    if name == "torque_delay":
        return replace_delay(model, 0.0)
    return model.with_law(FrictionLaw(tuple(term for term in model.law.terms if term.name != name)))


def replace_gravity(model: FrictionModel, given: RigidJoint) -> FrictionModel:
    """The model with the gravity of the simulation."""
    assert model.dynamics is not None
    cosine, sine = given.gravity
    return replace(model, dynamics=replace(model.dynamics, gravity_cosine=cosine, gravity_sine=sine))


def replace_delay(model: FrictionModel, delay: float) -> FrictionModel:
    """The model with a torque that acts so long after its stamp [s]."""
    assert model.dynamics is not None
    return replace(model, dynamics=replace(model.dynamics, torque_delay=delay))


def _add(model: FrictionModel, term: Term) -> FrictionModel:
    return model.with_law(FrictionLaw((*model.law.terms, term)))


def _measure_load(model: FrictionModel, motion: RecordedMotion) -> float:
    """Deviation of the size of the load over the motion [N·m]."""
    assert model.dynamics is not None
    found = []
    for part in motion.parts:
        load = part.channels.get("load_torque")
        load = model.dynamics.compute_gravity(part.position) if load is None else load
        found.append(np.abs(load)[part.moves] if np.ndim(load) else np.zeros(1))
    return float(np.std(np.concatenate(found)))


def find_highest_order(motion: RecordedMotion) -> float:
    """Order up to which a ripple passes in the band at the usual speed [1/rad] or [1/m]."""
    speed = np.concatenate([np.abs(part.smooth_velocity[part.moves]) for part in motion.parts])
    return 2.0 * np.pi * LOW_RATE.of_band * motion.band / max(float(np.median(speed)), 1e-12)


@dataclass(frozen=True)
class _Rows:
    """Samples in which the joint moves, and what a fit leaves of their torque. Shape (n,) each.

    Attributes:
        position: q [rad] or [m].
        velocity: v [rad/s] or [m/s].
        left: Torque that is left [N·m] or [N].
    """

    position: FloatArray
    velocity: FloatArray
    left: FloatArray

    @classmethod
    def gather(cls, base: Fitted, motion: RecordedMotion) -> _Rows:
        """Of all parts of a motion."""
        known = np.isfinite(base.left)
        position, velocity = (
            np.concatenate([getattr(part, name) for part in motion.parts])[known]
            for name in ("position", "smooth_velocity")
        )
        return cls(position, velocity, base.left[known])


def _find_wave(rows: _Rows, motion: RecordedMotion, term: type[Cogging | PositionCoulomb]) -> Term | None:
    """A wave of the order that explains most of what is left; None where the range holds no wave of the band."""
    q, is_level = rows.position, term is POSITION_COULOMB_TERMS[0]
    sign = np.sign(rows.velocity) if is_level else np.ones(q.size)
    step = 2.0 * np.pi / max(float(np.ptp(q)), 1e-12)
    fewest = LOW_RATE.levels_of_range if is_level else LOW_RATE.orders_of_range
    gravity = 0.0 if is_level or motion.position_unit != "rad" else 1.0
    lowest, highest = gravity + fewest * step, find_highest_order(motion)
    count = int((highest - lowest) / (LOW_RATE.order_steps * step)) + 1
    if highest <= lowest or count > LOW_RATE.most_orders:
        count, highest = LOW_RATE.most_orders, min(highest, lowest + LOW_RATE.most_orders * LOW_RATE.order_steps * step)
    if highest <= lowest:
        return None
    orders, signed = np.linspace(lowest, highest, count), rows.left * sign
    best = max(orders, key=lambda order: abs(complex(np.mean(signed * np.exp(1j * order * q)))))
    waves = np.column_stack([sign * np.sin(best * q), sign * np.cos(best * q)])
    sine, cosine = _solve(waves, rows.left)
    return term(float(sine), float(cosine), float(best))


def _find_stop(rows: _Rows) -> EndStop | None:
    """A stop at the edge, of those off both ends of the range, that explains most of what is left beside gravity and
    inertia, which a fit without a stop bends; None where none pushes back."""
    q = rows.position
    plain = np.column_stack([np.ones(q.size), np.sin(q), np.cos(q), np.sign(rows.velocity), rows.velocity])
    found = []
    for side in (1.0, -1.0):
        for edge in np.quantile(side * q, LOW_RATE.stop_edges):
            columns = np.column_stack([plain, side * np.maximum(side * q - edge, 0.0)])
            numbers = _solve(columns, rows.left)
            left = rows.left - columns @ numbers
            if numbers[-1] > 0.0:
                found.append((float(left @ left), float(numbers[-1]), side * float(edge), side))
    if not found:
        return None
    _, stiffness, edge, side = min(found)
    return EndStop(stiffness, edge, side)


def _solve(columns: FloatArray, target: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.lstsq(columns, target, rcond=None)[0])
