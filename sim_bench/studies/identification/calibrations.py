"""Ten seeds of the whole calibration on a joint whose friction is known."""

from collections.abc import Callable, Iterable
from pathlib import Path

from fricomp.calibration.sweep import CalibrationRequest, RunFolder, SweepContext, SweepSettings
from fricomp.calibration.sweep.calibrate import calibrate

from ...stand_in import DEFAULT_LAW, SimulatedJointAdapter, default_joint
from .seed_study import Score, SeedStudy, score


def study_calibrations(
    seeds: Iterable[int], folder: Path, report: Callable[[str, float], None] = lambda text, done: None
) -> SeedStudy:
    """Calibrate the stand-in's default joint once a seed and compare with its friction.

    Args:
        seeds: Of its noise; one calibration each.
        folder: Holds one run a seed; those of an earlier study are replaced.
        report: Told about progress.
    """
    wanted, statuses = list(seeds), []
    scores: list[Score] = []
    for index, seed in enumerate(wanted):
        report(f"seed {seed}", index / len(wanted))
        request = CalibrationRequest("sim", settings=SweepSettings(seed=seed))
        with SimulatedJointAdapter(default_joint(seed=seed)) as adapter:
            run = RunFolder.create(folder / f"seed-{seed}", request, overwrite=True)
            calibration = calibrate(SweepContext(adapter, 0, request.settings), run, request.options)
        result = calibration.estimate.result
        scores += score(result, DEFAULT_LAW, seed)
        statuses.append(str(result.status))
    return SeedStudy(tuple(scores), tuple(statuses))
