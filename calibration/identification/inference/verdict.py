"""Whether an identification can be trusted."""

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from ..estimation.form import SeparableLaw
from ..estimation.information import invert_information
from ..estimation.observation import Observations
from ..estimation.optimum import Optimum
from ..status import Status
from .adequacy import OpenBend, compute_misfit_p_value, find_driven_directions, find_open_bends

BASIN_GAP = 0.01
"""Difference in negative log-likelihood beyond which another basin is better."""
CLOSE_ENOUGH = 0.05
"""Distance from the likelihood optimum, in standard deviations of each parameter, that counts as converged."""
RIVAL = 2.0
"""A basin less likely by no more than this [nats] cannot be told from the best."""
_UNKNOWN = 1.0
"""Relative standard deviation from which a positive parameter is not identified."""
_NEGLIGIBLE = 0.05
"""Share of the largest torque, at the fastest speed, within which a viscous coefficient may be unknown, and of the mean
torque, over the loads, within which a sensitivity to the load may be."""
_MISFIT = 1e-3
"""Chance below which what the law leaves is no scatter; 1 of 1000 identifications that follow it is doubted."""
_MISFIT_MESSAGE = (
    "the points depart from the law, beyond their scatter, in a way that goes on over speed (chance {:.1g}): intervals "
    "hold only where the law does; look at the residuals, compare laws (--law auto), or let a network depart (--depart)"
)


class Verdict(NamedTuple):
    """The status of an identification.

    Attributes:
        status: In a word.
        message: In a sentence.
        distance: Largest distance of a parameter from the likelihood optimum, in standard deviations.
    """

    status: Status
    message: str
    distance: float


def covariance_of(found: Optimum) -> FloatArray:
    """Inverse Fisher information of the parameters. Shape (n_parameters, n_parameters).

    What the data say nothing about has a standard deviation of `information.UNDETERMINED` times its value.
    """
    information = found.noise.information(found.whitened, found.magnitude, found.jacobian)
    values = np.exp(found.logs)
    return np.asarray(invert_information(information) * np.outer(values, values))


def judge(
    found: Optimum,
    reference: Optimum,
    covariance: FloatArray,
    form: SeparableLaw,
    points: Observations,
    *,
    independent: bool = True,
) -> Verdict:
    """Compare what was found with the best basin of variable projection and least squares, and with the points.

    What the data do not determine comes before convergence: along such a direction the likelihood is flat, and where
    training stopped on it says nothing.

    Args:
        found: Where the fit ended.
        reference: The best basin.
        covariance: Of the parameters. Shape (n_parameters, n_parameters).
        form: The law.
        points: The data.
        independent: Whether their errors are; what shows as a misfit of the law may else be what errors share.
    """
    deviation = np.sqrt(np.diag(covariance))
    values, best = np.exp(found.logs), np.exp(reference.logs)
    rounding = 1e-9 * best
    distance = float(np.max(np.abs(values - best) / (deviation + rounding)))
    gap = found.negative_log_likelihood - reference.negative_log_likelihood
    exact = found.is_exact()
    if not exact and gap > BASIN_GAP and distance > 1.0:
        return Verdict(
            Status.NOT_CONVERGED,  # not merely suspected: such a model is refused wherever one is used
            f"another basin is more likely by {gap:.3g} nats; do not use these parameters",
            distance,
        )
    unknown = _find_unknown(found, deviation, form, points, exact=exact, independent=independent)
    if unknown:
        return Verdict(Status.NOT_IDENTIFIABLE, unknown, distance)
    if not exact and distance > CLOSE_ENOUGH:
        return Verdict(
            Status.NOT_CONVERGED, f"training stopped {distance:.2g} standard deviations from the optimum", distance
        )
    chance = 1.0 if exact or not independent else compute_misfit_p_value(found, points)
    if chance < _MISFIT:
        return Verdict(Status.LACK_OF_FIT, _MISFIT_MESSAGE.format(chance), distance)
    rival = nearest_rival(reference)
    if not exact and rival < RIVAL:
        return Verdict(
            Status.WRONG_BASIN_SUSPECTED, f"a second basin is less likely by only {rival:.2g} nats", distance
        )
    return Verdict(Status.CONVERGED, "converged to the likelihood optimum", distance)


def _find_unknown(
    found: Optimum, deviation: FloatArray, form: SeparableLaw, points: Observations, *, exact: bool, independent: bool
) -> str:
    """What the points do not determine, in a sentence; empty where they determine everything."""
    driven = find_driven_directions(points) if independent else []
    if driven:
        return _describe_driven(driven, points)
    bends = [] if exact else find_open_bends(found, form, points)
    flat = [bend.branch for bend in bends if bend.side == "none"]
    if flat:
        return _describe_flat(flat, form, points)
    known = zip(np.exp(found.logs).tolist(), deviation.tolist(), strict=True)
    vague = find_vague(dict(zip(form.names, known, strict=True)), points)
    if bends:
        return _open_message(bends, vague, form, points)
    return vague_message(vague, points) if vague else ""


def _describe_driven(driven: list[str], points: Observations) -> str:
    offset = points.compute_asymmetry()
    size = "" if offset is None else f", of {offset:.3g} if friction is the same in both directions"
    return (
        f"friction in {' and '.join(driven)} has the sign that drives the joint: the torque holds an offset or "
        f"gravity{size}; take it off first, or identify a recorded motion, with gravity where it acts"
    )


def _describe_flat(branches: list[int], form: SeparableLaw, points: Observations) -> str:
    sides = " and ".join(("forward", "reverse")[branch] for branch in branches)
    where = f" in {sides} direction" if form.bidirectional else ""
    low, high = float(points.speed.min()), float(points.speed.max())
    return (
        f"no Stribeck effect shows{where} between {low:.3g} and {high:.3g}: take a law without one (coulomb_viscous or "
        f"asymmetric_coulomb_viscous; of a table also auto), or add speeds below {low:.3g} where one is expected there"
    )


def _open_message(bends: list[OpenBend], vague: list[str], form: SeparableLaw, points: Observations) -> str:
    low, high = float(points.speed.min()), float(points.speed.max())
    names, cures = list(vague), []
    for branch, side in bends:
        of_branch = form.names[branch * form.branch_size : (branch + 1) * form.branch_size]
        names += [name for name in of_branch if name.endswith(_ABOVE if side == "above" else _BELOW)]
        cures.append(f"above {high:.3g}" if side == "above" else f"below {low:.3g}")
    return (
        f"the data do not determine {', '.join(dict.fromkeys(names))}: they fit as well with a bend far from the "
        f"speeds measured; add speeds {' and '.join(dict.fromkeys(cures))}, or take a law without them"
    )


def nearest_rival(optimum: Optimum) -> float:
    """How much less likely the next basin is than this one [nats]; infinity where there is none."""
    gaps = [other - optimum.negative_log_likelihood for other in optimum.other_basins]
    return min((gap for gap in gaps if gap > BASIN_GAP), default=np.inf)


_BELOW = ("static_torque", "stribeck_velocity", "stribeck_exponent", "smoothing_velocity")
"""Parameters that show at low speeds."""
_ABOVE = ("coulomb_torque", "stribeck_velocity", "stribeck_exponent", "smoothing_velocity")
"""Parameters that only show where the curve has bent."""


def find_vague(found: dict[str, tuple[float, float]], points: Observations) -> list[str]:
    """Names of the parameters, of these values and standard deviations, that the data do not determine.

    A viscous coefficient near zero is known well enough where what it adds at the fastest speed is, and a sensitivity
    to the load near zero where what it changes over the loads is.
    """
    harmless = {"viscous_coefficient": _NEGLIGIBLE * points.torque_scale / float(points.speed.max())}
    load = points.normal_load
    if load is not None and float(np.ptp(load)) > 0.0:
        harmless["load_sensitivity"] = _NEGLIGIBLE * float(np.mean(load) / np.ptp(load))
    return [
        name
        for name, (value, deviation) in found.items()
        if deviation > _UNKNOWN * value and not deviation < harmless.get(name.rpartition(".")[2], 0.0)
    ]


def vague_message(vague: list[str], points: Observations) -> str:
    """What is not determined, and which speeds would determine it."""
    low, high = float(points.speed.min()), float(points.speed.max())
    where = f"below {low:.3g}" if any(name.endswith(_BELOW) for name in vague) else f"outside {low:.3g} to {high:.3g}"
    return (
        f"the data do not determine {', '.join(vague)}: the standard deviation exceeds the value; add speeds {where}, "
        "where none was measured, or take a law without them"
    )
