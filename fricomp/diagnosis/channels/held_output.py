"""A drive whose output is held: how far it winds up, the way without torque, and the friction inside of the gear."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from fricomp.recording import Recording
from fricomp.recording.checks.motion_kind import Clamp, find_held_output, fit_clamp

from ..effects import EFFECTS
from ..record.result import NamedEffect, Quantity
from .settings import CHANNELS


def read_held_output(recording: Recording) -> tuple[NamedEffect, ...]:
    """Elasticity, with the friction inside, and backlash; nothing where no output is held."""
    if not find_held_output(recording):
        return ()
    whole, parts = fit_clamp(recording), _fit_parts(recording)
    unit, angle = recording.metadata.torque_unit, recording.metadata.position_unit
    stiffness = _measure(whole, parts, lambda one: one.stiffness, f"{unit}/{angle}")
    friction = _measure(whole, parts, lambda one: one.friction, unit)
    gap = _measure(whole, parts, lambda one: one.gap, angle)
    found = [_describe_elasticity(whole, stiffness, friction)] if stiffness.ci95[0] > 0.0 else []
    wide = gap.ci95[0] > CHANNELS.gap * float(np.ptp(recording.position))
    if wide and whole.residual < CHANNELS.abrupt * whole.stiffening_residual:
        found.append(_describe_backlash(gap))
    return tuple(found)


def _fit_parts(recording: Recording) -> list[Clamp]:
    """Each stretch of time on its own, where the torque goes both ways in it."""
    edges = np.linspace(0, len(recording), CHANNELS.blocks + 1).astype(int)
    parts = [recording.rows(slice(int(a), int(b))) for a, b in pairwise(edges)]
    both = [one for one in parts if np.min(one.torque) < 0.0 < np.max(one.torque)]
    return [fit_clamp(one) for one in both]


def _measure(whole: Clamp, parts: Sequence[Clamp], read: Callable[[Clamp], float], unit: str) -> Quantity:
    """A number of the whole; its interval holds how the stretches differ, and what the law's form leaves."""
    value = read(whole)
    spread = float(np.std([read(one) for one in parts], ddof=1)) if len(parts) > 1 else abs(value)
    half = 1.96 * float(np.hypot(spread, CHANNELS.form * value))
    return Quantity(value, unit, (max(value - half, 0.0), value + half))


def _describe_elasticity(clamp: Clamp, stiffness: Quantity, friction: Quantity) -> NamedEffect:
    effect = EFFECTS["joint_elasticity"]
    angle = stiffness.unit.rpartition("/")[2]
    inside = {"friction_inside": friction} if friction.ci95[0] > 0.0 else {}
    return NamedEffect(
        name=effect.name,
        kind=effect.kind,
        parameters={"stiffness": stiffness, **inside},
        equation="theta = play(tau) / K + gap",
        sentence=(
            "the output is held and winds up with the torque, what holds it included; "
            f"{1e3 * clamp.residual:.2g} m{angle} are left of {1e3 * clamp.linear_residual:.2g} of a straight spring"
        ),
        citation=effect.citation,
    )


def _describe_backlash(gap: Quantity) -> NamedEffect:
    effect = EFFECTS["backlash"]
    return NamedEffect(
        name=effect.name,
        kind=effect.kind,
        parameters={"gap": gap},
        equation="theta jumps by the gap where the torque changes its sign",
        sentence="a gap lets the held output go whenever the torque changes its sign",
        citation=effect.citation,
    )
