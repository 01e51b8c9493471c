"""What comparisons with a given simulation share: how far refits stray, and the weighing of hypotheses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from ..inputs.track import FloatArray
from ..joint.observer import Plant
from ..record.result import Change, Kind, Location, NamedEffect, Quantity
from .settings import PARAMETERS


@dataclass(frozen=True)
class Tolerances:
    """Standard deviations by which refitted parameters stray beyond what the fit knows of its own error.

    Attributes:
        inertia: Over the inertia.
        accelerating: Of the torque that the inertia takes at the RMS acceleration, over the Coulomb level: friction of
            slightly another form leans on the inertia the more, the less there is to accelerate.
        gravity: Over its amplitude.
        sliding: Of gravity, over the Coulomb level.
        uneven: Of the offset with half the difference of the directions, and of the shapes of the two curves by as much
            torque, over the Coulomb level.
        known: Factor on the deviations that the fit does know of.
    """

    inertia: float
    accelerating: float
    gravity: float
    sliding: float
    uneven: float
    known: float = 1.0


PLAIN = Tolerances(inertia=1e-4, accelerating=1e-4, gravity=5e-5, sliding=5e-4, uneven=6e-4)
"""How far parameters strayed on simulated joints with nothing missing. Smaller numbers would name parameters that are
right."""

NAMED = Tolerances(inertia=0.005, accelerating=4e-4, gravity=2e-3, sliding=3e-3, uneven=3e-3, known=1.5)
"""How far they strayed on simulated joints beside one strong effect that was named. Of 22 joints whose simulation was
wrong beside a named effect the fit's own intervals held 54 of 66 true values, hence the factor on them."""

AGREES = Tolerances(inertia=1e-4, accelerating=4e-4, gravity=3e-4, sliding=1e-3, uneven=3e-4)
"""How far an explanation that leaves the simulation as it is may move its parameters: between the two above, chosen on
development cases. Larger numbers take explanations for agreeing that bend gravity."""

UNEXPLAINED = Tolerances(inertia=0.02, accelerating=4e-4, gravity=0.01, sliding=0.02, uneven=0.02)
"""How far they strayed on simulated joints with something that was not named, which biases all of them."""


@dataclass(frozen=True)
class Shift:
    """A parameter of the simulation, or of the recorded signals, that is not as it was given.

    Attributes:
        name: Of the effect in the catalogue.
        parameters: By how much it is off.
        sentence: What that means, in words.
        kind: "parameter" or "measurement".
        alike: Other names for the same shift.
        equation: Its equation; empty where the sentence says it.
        citation: Key in the list of references; empty where no source is needed.
    """

    name: str
    parameters: dict[str, Quantity]
    sentence: str
    kind: Kind = "parameter"
    alike: tuple[str, ...] = ()
    equation: str = ""
    citation: str = ""

    def to_effect(
        self, share: float = 0.0, location: Location | None = None, instead: Sequence[str] = ()
    ) -> NamedEffect:
        """The effect of an answer.

        Args:
            share: Of the mismatch; 0 where it is in the joint that all errors are of.
            location: Where it shows; None where nobody looked.
            instead: Further effects that explain as much.
        """
        return NamedEffect(
            name=self.name,
            kind=self.kind,
            parameters=self.parameters,
            indistinguishable_from=(*self.alike, *instead),
            location=location or {},
            share=share,
            equation=self.equation,
            sentence=self.sentence,
            citation=self.citation,
        )


@dataclass(frozen=True)
class Comparison:
    """What differs from the given simulation and friction.

    Attributes:
        shifts: By the names of the catalogue.
        changes: The parameters behind them, beside the given ones.
    """

    shifts: tuple[Shift, ...] = ()
    changes: tuple[Change, ...] = ()


def compute_tolerances(noise_ratio: float) -> Tolerances:
    """Tolerances beside named effects that make the base's residual so many times its noise.

    A law of slightly another form leaves a part of the effect's size, so that parameters stray the less, the weaker the
    effect is.
    """
    share = min(float(np.sqrt(max(noise_ratio**2 - 1.0, 0.0))) / PARAMETERS.strong, 1.0)
    between = (plain + share * (named - plain) for plain, named in zip(astuple(PLAIN), astuple(NAMED), strict=True))
    return replace(Tolerances(*between), known=NAMED.known)


def compute_inertia_stray(plant: Plant, tolerances: Tolerances, acceleration: float) -> float:
    """Standard deviation of log inertia beyond what the fit knows of its own error."""
    accelerating = tolerances.accelerating * plant.level / max(plant.inertia * acceleration, 1e-12)
    return float(np.hypot(tolerances.inertia, accelerating))


def compute_body_strays(plant: Plant, gravity: float, tolerances: Tolerances, acceleration: float) -> FloatArray:
    """Standard deviations of log inertia and both gravity coefficients, whose amplitude is `gravity`, beyond what the
    fit knows of its own error. Shape (3,).

    Gravity far below friction says nothing about a gain: the floor keeps chi squared from tiny biases.
    """
    least = max(float(np.hypot(tolerances.gravity * gravity, tolerances.sliding * plant.level)), 1e-12)
    return np.array([compute_inertia_stray(plant, tolerances, acceleration), least, least])


def weigh_hypotheses(
    shift: FloatArray, weight: FloatArray, hypotheses: dict[str, FloatArray]
) -> tuple[dict[str, float], dict[str, FloatArray]]:
    """Chi squared that each hypothesis leaves of `shift`, with a penalty for its parameters, and those.

    Args:
        shift: From the given parameters. Shape (n,).
        weight: Inverse of its covariance. Shape (n, n).
        hypotheses: Directions in which the shift may lie. Shapes (n, m).
    """
    scores: dict[str, float] = {"": float(shift @ weight @ shift)}
    fitted: dict[str, FloatArray] = {}
    for name, span in hypotheses.items():
        normal = span.T @ weight @ span + 1e-12 * np.eye(span.shape[1])
        step = np.asarray(np.linalg.solve(normal, span.T @ weight @ shift), dtype=np.float64)
        rest = shift - span @ step
        scores[name], fitted[name] = float(rest @ weight @ rest) + PARAMETERS.simpler * span.shape[1], step
    return scores, fitted


def describe_change(name: str, given: float, refitted: float, deviation: float, unit: str) -> Change:
    """A parameter beside the given one, with the interval of its standard deviation."""
    half = 1.96 * deviation
    return Change(name=name, given=given, refitted=Quantity(refitted, unit, (refitted - half, refitted + half)))
