"""Ten seeds of the whole calibration on a joint whose friction is known."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.adapters import JointAdapter
from fricomp.laws import FrictionLaw
from fricomp.report import Chart, Panel, Points, Rule

from ..identification.chart import REACH
from .calibrate import Calibration, calibrate
from .context import SweepContext
from .request import CalibrationRequest
from .run_folder import RunFolder
from .settings import SweepSettings

__all__ = ["Score", "SeedStudy", "study_seeds"]


@dataclass(frozen=True)
class Score:
    """One parameter of one calibration.

    Attributes:
        seed: Of noise and order.
        name: Of the parameter.
        error: Estimate over truth, less one [1].
        normalised: Error in standard deviations of the estimate.
        covered: Whether the 95 % interval holds the truth.
    """

    seed: int
    name: str
    error: float
    normalised: float
    covered: bool


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
                "of": len(self.of(name)),
                "errors": [score.error for score in self.of(name)],
                "in_standard_deviations": [score.normalised for score in self.of(name)],
            }
            for name in self.names
        }
        return {"coverage": self.coverage(), "statuses": list(self.statuses), "parameters": parameters}

    def chart(self) -> Chart:
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
        return Chart("seeds", "Calibrations of the default joint, one point a seed", panels, 2, caption=labels)


def study_seeds(
    make_adapter: Callable[[int], JointAdapter],
    truth: FrictionLaw,
    seeds: Iterable[int],
    folder: Path,
    report: Callable[[str, float], None] = lambda text, done: None,
) -> SeedStudy:
    """Calibrate once a seed and compare with the truth.

    Args:
        make_adapter: The joint with this seed of its noise.
        truth: Its friction.
        seeds: One calibration each.
        folder: Holds one run a seed; those of an earlier study are replaced.
        report: Told about progress.
    """
    wanted, statuses = list(seeds), []
    scores: list[Score] = []
    for index, seed in enumerate(wanted):
        report(f"seed {seed}", index / len(wanted))
        request = CalibrationRequest("sim", settings=SweepSettings(seed=seed))
        with make_adapter(seed) as adapter:
            run = RunFolder.create(folder / f"seed-{seed}", request, overwrite=True)
            calibration = calibrate(SweepContext(adapter, 0, request.settings), run, request.options)
        scores += score(calibration, truth, seed)
        statuses.append(str(calibration.estimate.result.status))
    return SeedStudy(tuple(scores), tuple(statuses))


def score(calibration: Calibration, truth: FrictionLaw, seed: int) -> Sequence[Score]:
    """Compare one calibration with the truth."""
    result, values = calibration.estimate.result, truth.parameters()
    scores = []
    for name in result.parameter_names:
        estimate, deviation, interval = result.parameters[name], result.standard_deviations[name], result.interval(name)
        covered = interval.lower <= values[name] <= interval.upper
        gap = estimate - values[name]
        scores.append(Score(seed, name, gap / values[name], gap / deviation, covered))
    return scores
