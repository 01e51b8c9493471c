"""Scores of identifications whose truth is known, one a seed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricomp.calibration.identification import IdentificationResult
from fricomp.calibration.identification.report.chart import REACH
from fricomp.laws import FrictionLaw
from fricomp.report import Chart, Panel, Points, Rule


@dataclass(frozen=True)
class Score:
    """One parameter of one identification.

    Attributes:
        seed: Of noise and order.
        name: Of the parameter.
        error: Estimate over truth, less one [1].
        normalised: Error in standard deviations of the estimate.
        covered: Whether the 95 % interval of the covariance holds the truth.
        profiled: The same by profile likelihood, where the parameter belongs to a bend.
    """

    seed: int
    name: str
    error: float
    normalised: float
    covered: bool
    profiled: bool | None = None

    @property
    def held(self) -> bool:
        """Whether the interval that the report prints last for this parameter holds the truth."""
        return self.covered if self.profiled is None else self.profiled


@dataclass(frozen=True)
class SeedStudy:
    """The scores of all parameters and seeds.

    Attributes:
        scores: In order of the seeds.
        statuses: Of each identification.
    """

    scores: tuple[Score, ...]
    statuses: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(dict.fromkeys(score.name for score in self.scores))

    def of(self, name: str) -> tuple[Score, ...]:
        """Scores of one parameter."""
        return tuple(score for score in self.scores if score.name == name)

    def mean_error(self, name: str) -> float:
        """Mean of the absolute errors of a parameter [1]."""
        return float(np.mean([abs(score.error) for score in self.of(name)]))

    def root_mean_square(self, name: str) -> float:
        """Of the errors in standard deviations; 1 where the uncertainty is right."""
        return float(np.sqrt(np.mean([score.normalised**2 for score in self.of(name)])))

    def coverage(self) -> float:
        """Share of the 95 % intervals that hold the truth [1]."""
        return float(np.mean([score.covered for score in self.scores]))

    def to_builtins(self) -> dict[str, Any]:
        """For a JSON file."""
        parameters = {
            name: {
                "mean_error": self.mean_error(name),
                "rms_in_standard_deviations": self.root_mean_square(name),
                "covered": sum(score.covered for score in self.of(name)),
                "held": sum(score.held for score in self.of(name)),
                "of": len(self.of(name)),
                "errors": [score.error for score in self.of(name)],
                "in_standard_deviations": [score.normalised for score in self.of(name)],
            }
            for name in self.names
        }
        return {"coverage": self.coverage(), "statuses": list(self.statuses), "parameters": parameters}

    def chart(self, title: str) -> Chart:
        """Errors of every parameter, in per cent and in standard deviations."""
        places = np.concatenate([np.full(len(self.of(name)), float(i)) for i, name in enumerate(self.names)])
        labels = ", ".join(f"{i} {name.removeprefix('stribeck.')}" for i, name in enumerate(self.names))
        percent = 100.0 * np.array([score.error for name in self.names for score in self.of(name)])
        deviations = np.array([score.normalised for name in self.names for score in self.of(name)])
        panels = (
            Panel((Points(places, percent),), "parameter", "error [%]", "Error"),
            Panel(
                (Rule(REACH, "y", "95 %"), Rule(-REACH), Points(places, deviations)),
                "parameter",
                "error [standard deviations]",
                "Error in its own standard deviations",
            ),
        )
        return Chart("seeds", title, panels, 2, caption=labels)


def score(result: IdentificationResult, truth: FrictionLaw, seed: int, *, profiles: bool = False) -> Sequence[Score]:
    """Compare one identification with the truth.

    Args:
        result: What was identified.
        truth: The joint's friction.
        seed: Of the joint's noise.
        profiles: Whether to work out the profile likelihood of the bend's parameters, which takes seconds with many
            points.
    """
    values, scores = truth.parameters(), []
    for name in result.parameter_names:
        true, deviation = values[name], result.standard_deviations[name]
        gap, covered = result.parameters[name] - true, result.interval(name).holds(true)
        profiled = result.profiles[name].holds(true) if profiles and name in result.profiles else None
        scores.append(Score(seed, name, gap / true, gap / deviation, covered, profiled))
    return scores
