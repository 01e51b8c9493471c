"""How much of the joint's inertia the load carries: it decides what load a gear feels while accelerating."""

from __future__ import annotations

from collections.abc import Sequence

from ...inputs.track import FloatArray
from ..context import Context
from ..effect import EffectParameter, Values

SHARE = EffectParameter("inertia_share", "1", 0.2, 0.0, 1.0, linear=False, prior=0.5, of_inertia=True)
"""Part of the joint's inertia that the load carries [1]: mostly gears and motor are a part of it that nobody knows."""


def propose_shares(contexts: Sequence[Context]) -> list[dict[str, float]]:
    """Gravity alone, and gravity with all inertia; one hypothesis where the load was recorded."""
    recorded = all("load_torque" in c.channels for c in contexts)
    # Nearly all: a start at the bound itself would leave the fit one way to go.
    return [{"inertia_share": 0.0}] if recorded else [{"inertia_share": 0.0}, {"inertia_share": 0.9}]


def compute_felt_load(context: Context, values: Values) -> FloatArray:
    """Transmitted load [N·m]: as recorded, else gravity and a share of the inertia."""
    if "load_torque" in context.channels:
        return context.load_torque
    return context.load_torque + values["inertia_share"] * context.plant.inertia * context.acceleration
