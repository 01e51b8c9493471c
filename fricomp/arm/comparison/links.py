"""What is said of single links: what they weigh, what this motion determines of it, and which of them are off."""

from __future__ import annotations

import numpy as np

from fricomp.diagnosis.record.result import Quantity
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from ..fit import Z95
from ..identification import ArmIdentification
from ..matter import LEAST_MATTER
from ..record import LinkRecord, LinkState
from ..rigid.inertia import N_INERTIA
from ..row_weights import BoolArray

_DETERMINED = 0.5
"""A link's mass counts as determined where the recording at least halves what was uncertain before."""

_Z_OFF = 3.5
"""Standard deviations by which a link must be off: with four numbers of each of seven links, one in a hundred healthy
arms reaches them."""

_AXES = ("x", "y", "z")


def measure_link_change(found: ArmIdentification, joint: int) -> float:
    """RMS of what links as found change of a joint's torque beside those of the simulation, as part of that torque."""
    return float(_measure_changes(found, slice(len(found.fit.arm.links)))[joint])


def describe_link(
    found: ArmIdentification, link: int, intervals: FloatArray, instead: tuple[str, ...] = ()
) -> LinkRecord:
    """What is said of one link.

    Args:
        found: The confirmed fit.
        link: Its number.
        intervals: Of its mass and first moments. Shape (4, 2).
        instead: Links that would do in its place, were they far off.
    """
    fit = found.fit
    at = slice(N_INERTIA * link, N_INERTIA * (link + 1))
    slope = fit.arm.link_coordinates[link].jacobian(fit.x[at])
    before = np.sqrt(np.diag(slope @ np.diag(fit.prior_deviation[at] ** 2) @ slope.T))
    value, simulated = fit.inertia[link], fit.arm.inertia[link]
    spread = (intervals[:, 1] - intervals[:, 0]) / (2.0 * Z95)
    determined = spread < _DETERMINED * before[:4]
    ends = [(float(low), float(high)) for low, high in intervals]
    far = determined & (np.abs(value - simulated)[:4] > _Z_OFF * spread)
    far = np.append(far, np.zeros(N_INERTIA - far.size, dtype=bool)) | (link in fit.model.opened)
    return LinkRecord(
        name=fit.arm.links[link],
        simulated_mass=float(simulated[0]),
        mass=Quantity(float(value[0]), "kg", ends[0]),
        first_moment={axis: Quantity(float(value[k]), "kg·m", ends[k]) for k, axis in enumerate(_AXES, start=1)},
        simulated_first_moment={axis: float(simulated[k]) for k, axis in enumerate(_AXES, start=1)},
        state=_judge_link(determined, off=_matters(found, link, far)),
        determined=tuple(name for name, known in zip(("mass", *_AXES), determined, strict=True) if known),
        instead=instead,
    )


def _judge_link(determined: BoolArray, *, off: bool) -> LinkState:
    if off:
        return "off"
    return "as_simulated" if np.any(determined) else "not_determined"


def _matters(found: ArmIdentification, link: int, far: BoolArray) -> bool:
    """Whether any joint would notice what is far off of a link.

    What else of it is elsewhere than in the simulation, neighbours make up for: torques tell the sum alone.
    """
    return bool(np.max(_measure_changes(found, slice(link, link + 1), far)) >= LEAST_MATTER)


def _measure_changes(found: ArmIdentification, links: slice, counted: BoolArray | None = None) -> FloatArray:
    """RMS of what some links as found change of each joint's torque, as part of that torque. Shape (n_joints,).

    Args:
        found: The confirmed fit.
        links: Their numbers.
        counted: Which of the ten numbers of each count; all by default. Shape (10,).
    """
    fit, columns = found.fit, slice(N_INERTIA * links.start if links.start else 0, N_INERTIA * links.stop)
    away = (fit.inertia - fit.arm.inertia)[links] * (1.0 if counted is None else counted)
    change = found.rows.links[:, :, columns] @ away.ravel()
    pairs = zip(change.T, found.rows.torque.T, strict=True)
    return np.array([compute_rms(one) / max(compute_rms(torque), 1e-300) for one, torque in pairs])
