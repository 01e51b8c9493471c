"""The models that are compared at low rates: the plain joint, and one with each effect that sliding shows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.evaluation import RecordedMotion
from fricomp.laws import COGGING_TERMS, Coulomb, FrictionLaw, LoadCoulomb, Term, Viscous
from fricomp.model import FrictionModel, JointDynamics, Provenance, Validity
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..inputs.track import FloatArray
from .held_out import Fitted
from .settings import LOW_RATE


@dataclass(frozen=True)
class Candidate:
    """An effect to try.

    Attributes:
        name: In the catalogue.
        model: To start the fit from.
        numbers: Its own numbers: names in the model.
        matters: Part of the held-out energy that it has to take.
    """

    name: str
    model: FrictionModel
    numbers: tuple[str, ...]
    matters: float


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
        provenance=Provenance(method="diagnosis", data_sha256=recordings[0].content_hash),
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
    names = {term.name for term in base.model.law.terms}
    load = _measure_load(base.model, motion)
    if "load_coulomb" not in names and load > LOW_RATE.load_matters * base.rms:
        loaded = _add(base.model, LoadCoulomb(0.05))
        yield Candidate("load_coulomb", loaded, ("load_coulomb.coefficient",), LOW_RATE.matters)
    ripple = _find_ripple(base, motion)
    if ripple is not None and not names & {term.name for term in COGGING_TERMS}:
        numbers = tuple(f"cogging.{name}" for name in ("sine", "cosine", "order"))
        yield Candidate("cogging", _add(base.model, ripple), numbers, LOW_RATE.ripple_matters)
    for delay in LOW_RATE.delays if may_be_late else ():
        yield Candidate("torque_delay", replace_delay(base.model, delay * period), ("torque_delay",), LOW_RATE.matters)


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


def _find_ripple(base: Fitted, motion: RecordedMotion) -> Term | None:
    """A wave of the order that explains most of what is left; None where the range holds no wave of the band."""
    position = np.concatenate([part.position for part in motion.parts])
    known = np.isfinite(base.left)
    q, left = position[known], base.left[known]
    step = 2.0 * np.pi / max(float(np.ptp(q)), 1e-12)
    lowest, highest = LOW_RATE.orders_of_range * step, find_highest_order(motion)
    count = int((highest - lowest) / (LOW_RATE.order_steps * step)) + 1
    if highest <= lowest or count > LOW_RATE.most_orders:
        count, highest = LOW_RATE.most_orders, min(highest, lowest + LOW_RATE.most_orders * LOW_RATE.order_steps * step)
    if highest <= lowest:
        return None
    orders = np.linspace(lowest, highest, count)
    best = max(orders, key=lambda order: abs(complex(np.mean(left * np.exp(1j * order * q)))))
    waves = np.column_stack([np.sin(best * q), np.cos(best * q)])
    sine, cosine = _solve(waves, left)
    return COGGING_TERMS[0](float(sine), float(cosine), float(best))


def _solve(columns: FloatArray, target: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.lstsq(columns, target, rcond=None)[0])
