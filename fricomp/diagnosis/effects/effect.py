"""What an effect of the catalogue is: a contribution to the simulated joint with parameters to fit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple

import numpy as np

from fricomp.laws import FrictionLaw, Term

from ..inputs.track import FloatArray
from ..joint.observer import Contribution, Plant
from .context import Context
from .forward_part import ForwardPart
from .settings import EFFECT

Kind = Literal["physics", "measurement", "parameter"]
Values = Mapping[str, float]


@dataclass(frozen=True)
class EffectParameter:
    """One number of an effect.

    Attributes:
        name: Literature name.
        unit: Unit; `{torque}` and `{position}` stand for the recording's own.
        scale: Change that matters, for steps and damping.
        lower: Lower bound; by default beyond every joint.
        upper: Upper bound; likewise.
        linear: Whether the contribution is proportional to it, so that it is zero where the effect is absent.
        prior: Standard deviation of a weak prior around the start; 0 for none.
        known: Standard deviation of what is known of it before a fit, in the solver's coordinates, for its interval; 0
            for that of the prior. Where a fit may start from several values, its prior only keeps it near its own one.
        logarithmic: Whether the number is fitted, and bounded, as its logarithm.
        form: Relative deviation that a law of slightly another form leaves in it, from simulated joints; None for the
            usual one of sizes.
        least_form: What such a law leaves however small the number is, in the solver's coordinates.
        with_delay: How it changes with the base's own delay where the recording stays as it is [1/s]: rows show a time
            by which the torque is late, and next to nothing of who makes it late.
        null: Value at which the effect is not there, of a number in which the contribution is not linear; None where
            it has none.
        searched: Whether its domain ends where the search ends, and not where physics does: a fit that stands there
            is no answer.
        at_lowest: What the effect would be at its lower bound, where that is another one: said where its interval
            reaches it. Empty where the bound is nothing special.
        of_inertia: Whether it is a part of the joint's inertia, and so another one where that is found to be another.
    """

    name: str
    unit: str
    scale: float
    lower: float = -EFFECT.unbounded
    upper: float = EFFECT.unbounded
    linear: bool = True
    prior: float = 0.0
    known: float = 0.0
    logarithmic: bool = False
    form: float | None = None
    least_form: float = 0.0
    with_delay: float = 0.0
    null: float | None = None
    searched: bool = False
    at_lowest: str = ""
    of_inertia: bool = False

    def is_at_end(self, value: float) -> bool:
        """Whether a value stands where the search of it ends, in the solver's coordinates; its null is no such end."""
        absent = self.null is not None and abs(value - self.null) < EFFECT.at_bound * self.scale
        return (self.linear or self.searched) and self.touches_end(value) and not absent

    def is_out_of_reach(self, value: float) -> bool:
        """Whether a value stands where its domain ends because recordings reach no further, as that of a stop at the
        other end which nothing meets: it says nothing."""
        if self.null is None or self.linear or self.searched:
            return False
        return abs(value - self.null) <= EFFECT.at_bound * (self.upper - self.lower)

    def touches_end(self, value: float, *, low: bool = True) -> bool:
        """Whether a value stands where its domain or the search of it ends, in the solver's coordinates; at the higher
        end alone where the lower one, `low`, does not count."""
        margin = EFFECT.at_bound * min(self.upper - self.lower, max(abs(value), self.scale))
        return value >= self.upper - margin or (low and value <= self.lower + margin)

    def compute_form_deviation(self, value: float) -> float:
        """Standard deviation that the law's form leaves, in the solver's coordinates."""
        usual = EFFECT.usual_form if self.linear or self.logarithmic else 0.0
        relative = usual if self.form is None else self.form
        return float(np.hypot(relative * (1.0 if self.logarithmic else abs(value)), self.least_form))


class PrintedForm(NamedTuple):
    """One of the forms of an effect that has several, as an answer prints it.

    Attributes:
        says: What is missing, in words.
        equation: Its law.
        numbers: Factor from each fitted number that stands in it to the printed one, and the unit of that, with
            `{torque}` and `{position}`. Other numbers are not printed.
    """

    says: str
    equation: str
    numbers: Mapping[str, tuple[float, str]]


class Effect(ABC):
    """One effect of the catalogue. Stateless; instances register under their name.

    Attributes:
        name: The literature's name.
        kind: What it is; decides the verdict.
        equation: Law of the effect, as the report prints it.
        citation: Key of its source in the references; empty where the law needs none.
        says: What is missing, in words for the report.
        like_friction: Whether the form of a friction that turns over otherwise than ours looks like a small one of it.
        shown_at_rest: Whether rows about rest speak for it too, and not only those in which the joint slides.
        like_a_bristle: Whether it takes up what the form of the bristle leaves about rest.
        scales_torque: Whether it scales the torque by a factor that changes with time, but hardly over the whole
            recording.
        misreads_position: Whether the encoder's error is a wave over the position.
        ripple: Whether it is a wave over the position with an `order`, a `sine` and a `cosine`.
        wave: Whether that wave is one of torque or one of friction, of which one part of a joint may make both.
        gain_share: Factor on the gain of explanations with it. It is less than 1 for an effect that can imitate others,
            or has more forms than they.
        beyond_law: Those of its numbers for which the term of a law has no place.
        imitates_others: Whether it can imitate effects of any form, so that what it adds completes no explanation.
        form_of_friction: Whether it is the form of the joint's own friction: beside another effect that covers the
            mismatch it is a remark, and no second effect.
        follows_load: Whether it is friction that changes with the load, which another joint has otherwise.
        viscous_exponent: Parameter that is the exponent of a curve over speed, for an effect that may take the place
            of all viscous friction; empty for others.
    """

    name: ClassVar[str]
    kind: ClassVar[Kind]
    equation: ClassVar[str]
    citation: ClassVar[str]
    says: ClassVar[str]
    like_friction: ClassVar[bool] = False
    shown_at_rest: ClassVar[bool] = False
    like_a_bristle: ClassVar[bool] = False
    scales_torque: ClassVar[bool] = False
    misreads_position: ClassVar[bool] = False
    ripple: ClassVar[bool] = False
    wave: ClassVar[Literal["", "torque", "friction"]] = ""
    gain_share: ClassVar[float] = 1.0
    beyond_law: ClassVar[tuple[str, ...]] = ()
    imitates_others: ClassVar[bool] = False
    form_of_friction: ClassVar[bool] = False
    follows_load: ClassVar[bool] = False
    viscous_exponent: ClassVar[str] = ""

    @abstractmethod
    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        """The effect's numbers, with scales for these recordings."""

    @abstractmethod
    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        """What the effect adds to the joint along one recording."""

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        """Propose starting values for the parameters in which the contribution is not linear."""
        return [{}]

    def propose_other_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        """Propose starts for the case that the fitted ones need another inertia or gravity than the simulation has."""
        return self.propose_starts(contexts)

    def propose_far_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        """Propose starts far from each other. They are fitted with care where no effect explains most of the
        mismatch."""
        return []

    def propose_shapes(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        """Propose values whose torque is a shape beside which the joint is estimated where the base is bent far; none
        of an effect that bends no base so far that a fit from there goes astray."""
        return []

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        """Propose many starts, of which simulation keeps the best; none where `propose_starts` is enough."""
        return []

    def recall_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        """Return the starts that were kept of `scan`, or all of them before that."""
        names = [p.name for p in self.list_parameters(contexts)]
        values = contexts[0].hints.get(f"start:{self.name}", ())
        found = [dict(zip(names, values[i : i + len(names)], strict=True)) for i in range(0, len(values), len(names))]
        return found or self.scan(contexts)

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        """Say why these recordings cannot show the effect; None where they can."""
        return None

    def is_suspected(self, contexts: Sequence[Context]) -> bool:
        """Tell whether the base itself points at the effect. It is then refitted however little its column explains."""
        return False

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        """Build the effect as a term beside the friction of the fitted `plant`; None where it is no term.

        `contexts` are those that its contribution was fitted along. What changes the curves or the bristle themselves
        is no term of its own: its contribution says so.
        """
        return None

    def build_terms(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> tuple[Term, ...]:
        """Build the effect as terms, of which a ripple with overtones has several."""
        term = self.build_term(values, plant, contexts)
        return () if term is None else (term,)

    def choose_form(self, values: Values, contexts: Sequence[Context]) -> PrintedForm | None:
        """The form that these values are of; None for an effect that has one only, printed with all its numbers."""
        return None

    def is_in_law(self, law: FrictionLaw) -> bool:
        """Whether the law of an extended model says all of the effect: as a term of its name, if nothing else."""
        return any(term.name == self.name for term in law.terms)

    def compute_curve(self, values: Values, speed: float) -> float | None:
        """Friction at a speed [N·m] of an effect that is a curve over speed alone; None for any other."""
        return None

    def build_forward_part(self, context: Context, values: Values) -> ForwardPart:
        """Build what the effect is in a forward simulation. An effect without a state adds what it adds along the
        recorded motion."""
        return ForwardPart(self.compute_contribution(context, values))

    def compute_load(self, context: Context, values: Values) -> FloatArray | float:
        """Compute the load that this effect adds to the joint, and that other effects feel as well [N·m]. Shape
        (n,)."""
        return 0.0

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        """Say why these values are not physical, or too small to be named; None where they are neither."""
        return None

    def doubt(self, values: Values, contexts: Sequence[Context]) -> str | None:
        """Say why these values give no name, though a search may come to others from them; None where they may."""
        return None

    def is_faint(self, values: Values, contexts: Sequence[Context]) -> bool:
        """Tell whether these values are physical and only too small to be named, so that something else may look like
        them."""
        return False


def compute_lowest_order(contexts: Sequence[Context]) -> float:
    """Lowest order over position that counts as a ripple: that of the fewest waves over the recorded range, and of the
    fewest that the motion passes: each angle that is passed once is as well a time."""
    span = max(float(np.ptp(context.position)) for context in contexts)
    travel = sum(float(np.sum(np.abs(context.velocity))) * context.dt for context in contexts)
    return 2.0 * np.pi * max(EFFECT.least_waves / max(span, 1e-9), EFFECT.least_passed / max(travel, 1e-9))


def refuse_large_loss(shares: Sequence[FloatArray]) -> str | None:
    """Refuse a drive that loses more of its torque than any does while it runs.

    Args:
        shares: Part of the torque that is missing in each recording [1]. Shapes (n,).
    """
    lost = max(float(np.quantile(np.abs(share), EFFECT.nearly_all)) for share in shares)
    return "most of the recorded torque would be lost" if lost > EFFECT.most_lost else None


def refuse_long_wave(order: float, contexts: Sequence[Context]) -> str | None:
    """Refuse a ripple whose fit went to the lowest order, since anything that varies slowly looks like that."""
    if order > (1.0 + EFFECT.at_bound) * compute_lowest_order(contexts):
        return None
    return "no period of it lies within the recorded range"


EFFECTS: dict[str, Effect] = {}


def register(effect: type[Effect]) -> type[Effect]:
    """Enter an effect into the catalogue."""
    EFFECTS[effect.name] = effect()
    return effect
