"""How late the torques of joints are beside each other."""

from __future__ import annotations

from collections.abc import Mapping

from fricomp.root_mean_square import compute_rms

from ..encoder_noise import compute_noise_torque
from ..friction import GEARS, TERMS
from ..identification import ArmIdentification
from ..matter import LEAST_MATTER
from ..search.early_torque import EarlyTorques

_SURE = 3.5
"""Standard deviations by which links must ask for another time: as many as whatever is taken in has."""

_HELD = 0.5
"""Of a row's time, by which torques and positions of one row may be apart."""

_LARGE = 0.02
"""Part of a joint's friction that such a time changes at least before it is told: a hundredth is left of joints in
which nothing is missing, and what a model has wrong bends times as well."""

_BLURRED = 0.5
"""Torque that the noise of an encoder looks like, as part of all that is left of its joint, from which nobody knows
when its links ask: the loop answers that noise, and the joint that answer, so that its links look early."""


def list_apart(found: ArmIdentification) -> Mapping[int, float]:
    """The delay that each joint asks for [s] by its number, where joints do not agree by what anybody would notice.

    Without noise they never agree: filters, and rows that hold until the next one, are seen in each.
    """
    _, friction = found.fit.predict(found.equations)
    for j, delay in found.delay.apart.items():
        moving = found.equations.moving[:, j]
        change = abs(delay - found.delay.value) * compute_rms(found.rows.torque_rate[moving, j])
        if change >= LEAST_MATTER * compute_rms(friction[moving, j]):
            return found.delay.apart
    return {}


def list_mistimed(found: ArmIdentification) -> Mapping[int, tuple[float, float]]:
    """By how much later than all torques what the links ask of a joint was recorded, with its deviation [s].

    Of joints that surely ask for that, and of which neither a delay nor a gear explains it: friction contradicts a
    delay, as it does where a drive lags whose joint sticks at every reversal. Not of those whose encoder is too coarse.
    """
    early, half = EarlyTorques(found.rows, found.equations, found.fit), _HELD * found.recording.period
    _, friction = found.fit.predict(found.equations)
    blurred = compute_noise_torque(found.rows, found.fit) > _BLURRED * found.equations.weights.noise
    result = {}
    for j, form in enumerate(found.fit.model.forms):
        if blurred[j] or any(TERMS[name].filled in ("delay", *GEARS) for name in form.names):
            continue
        time, moving = early.measure(j), found.equations.moving[:, j]
        value, deviation = float(time.values[0]), float(time.deviations[0])
        change = abs(value) * compute_rms(found.rows.torque_rate[moving, j])
        if abs(value) > half + _SURE * deviation and change >= _LARGE * compute_rms(friction[moving, j]):
            result[j] = (value, deviation)
    return result
