"""A stop or bumper at the end of the range, or at both ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from fricomp.laws import EndStop as EndStopTerm
from fricomp.laws import Term

from ...inputs.track import FloatArray
from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class EndStop(Effect):
    """tau = (k d (1 + h d) + c v + m a)_+ beyond q_max, with d = q - q_max. A stop dissipates by c, and pushes only.

    A bumper stiffens by h as it is pressed. A like one may stand at the other end, by the way to it; where nothing
    meets it, that is the range.

    What moves with it weighs m. So does the joint at a limit of MuJoCo, which takes the share d of all other torques
    away: it is J / (1 - d) heavy there. A law has no m.
    """

    name = "end_stop"
    kind = "physics"
    equation = "tau = max(k d (1 + h d) + c v + m a, 0), d = q - q_max > 0; the like at the other end"
    citation = ""
    says = "a stop pushes back at the end of the range"
    shown_at_rest = True
    beyond_law = ("inertia",)
    edges: ClassVar[tuple[float, ...]] = (0.02, 0.06, 0.12, 0.2)
    """Distances from the ends of the range, in that range, at which a fit looks for the edge of a stop. They lie closer
    at the ends, where a hard stop is met for a short way only."""
    met: ClassVar[float] = 0.01
    """Part of the range in which a fit begins with a stop at the other end as well: one that nothing meets gives it no
    slope, and would stay out."""
    shapes: ClassVar[int] = 14
    """Edges off either end beside which the joint is estimated where the base is bent far. Between fewer of them the
    gravity takes over what one that is off leaves."""
    edge_step: ClassVar[float] = 0.02
    """Change of an edge that matters [rad] or [m]."""
    edge_strays: ClassVar[float] = 1.5e-4
    """By how much the form of a stop moves its edge, in the range: how it stiffens trades with where it begins."""
    usual_time: ClassVar[float] = 0.02
    """Damping over stiffness that matters [s]."""
    usual_depth: ClassVar[float] = 0.1
    """Part of the range over which a bumper is pressed, for the hardening that matters."""
    stiffens: ClassVar[float] = 0.3
    """Change of the hardening over that depth that matters [1]."""
    hardest: ClassVar[float] = 30.0
    """Largest hardening over that depth: the force is nearly a square then, whatever the stiffness."""
    widest: ClassVar[float] = 0.35
    """Largest part of the samples and of the range in which it may act, since a stop is at the end of the range."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale, (low, high) = contexts[0].scale, _find_range(contexts)
        span = high - low
        usual = 1.0 / (self.usual_depth * span)
        return (
            EffectParameter("stiffness", "{torque}/{position}", scale),
            EffectParameter("damping", "{torque}·s/{position}", self.usual_time * scale, 0.0, null=0.0),
            EffectParameter("inertia", "{torque}·s²/{position}", self.usual_time**2 * scale, 0.0, null=0.0),
            EffectParameter("edge", "{position}", self.edge_step, linear=False, least_form=self.edge_strays * span),
            EffectParameter("side", "1", 0.0, -1.0, 1.0, linear=False),
            EffectParameter(
                "travel",
                "{position}",
                self.edge_step,
                (1.0 - 2.0 * self.widest) * span,
                span,
                linear=False,
                null=span,
                least_form=2.0 * self.edge_strays * span,
            ),
            EffectParameter(
                "hardening", "1/{position}", self.stiffens * usual, 0.0, self.hardest * usual, linear=False, null=0.0
            ),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self._propose_edges(contexts, self.edges)

    def propose_shapes(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        names = [p.name for p in self.list_parameters(contexts)]
        close = np.linspace(0.0, self.widest, self.shapes + 1)[1:]
        starts = self._propose_edges(contexts, [float(one) for one in close])
        return [dict.fromkeys(names, 0.0) | start | {"stiffness": 1.0} for start in starts]

    def _propose_edges(self, contexts: Sequence[Context], parts: Sequence[float]) -> list[dict[str, float]]:
        """Edges at parts of the range off both ends, alone and with one at the other end."""
        low, high = _find_range(contexts)
        span = high - low
        starts = []
        for f in parts:
            far = (-f, self.met, f)  # at the other end: beyond the range, at its end, and where it is here
            starts += [{"edge": high - f * span, "side": 1.0, "travel": (1.0 - f - g) * span} for g in far]
            starts += [{"edge": low + f * span, "side": -1.0, "travel": (1.0 - f - g) * span} for g in far[:2]]
        return starts

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        v, a = context.quick_velocity, context.quick_acceleration
        torque = sum(
            side * self._push(side * (context.position - edge), side * v, side * a, values)
            for side, edge in _list_edges(values)
        )
        return Contribution(additive=np.asarray(torque))

    def _push(self, depth: FloatArray, speed: FloatArray, growth: FloatArray, values: Values) -> FloatArray:
        moved = values["damping"] * speed + values["inertia"] * growth
        pressed = np.maximum(depth, 0.0)
        spring = values["stiffness"] * pressed * (1.0 + values["hardening"] * pressed)
        return np.maximum(spring + moved * (depth > 0.0), 0.0)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        if values["stiffness"] <= 0.0:
            return "the stop would pull outwards"
        low, high = _find_range(contexts)
        widest = 0.0
        for side, edge in _list_edges(values):
            inside = np.mean([np.mean(side * (c.position - edge) > 0.0) for c in contexts])
            widest = max(widest, float(inside), _measure_reach(side, edge, contexts) / (high - low))
        return "it would act over more than a third of the range" if widest > self.widest else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        _, (side, other) = _list_edges(values)
        travel = values["travel"] if _measure_reach(side, other, contexts) > 0.0 else 0.0
        return EndStopTerm(
            values["stiffness"], values["edge"], values["side"], values["damping"], travel, values["hardening"]
        )


def _list_edges(values: Values) -> tuple[tuple[float, float], tuple[float, float]]:
    """Side and edge of the stop, and of the like one at the other end."""
    side, edge = values["side"], values["edge"]
    return (side, edge), (-side, edge - side * values["travel"])


def _measure_reach(side: float, edge: float, contexts: Sequence[Context]) -> float:
    """How far the recordings go beyond an edge [rad] or [m]."""
    low, high = _find_range(contexts)
    return high - edge if side > 0.0 else edge - low


def _find_range(contexts: Sequence[Context]) -> tuple[float, float]:
    """Least and largest position of all recordings [rad] or [m]."""
    return min(float(c.position.min()) for c in contexts), max(float(c.position.max()) for c in contexts)
