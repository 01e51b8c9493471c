"""Ten seeds of the whole calibration on a joint whose friction is known."""

from collections.abc import Callable, Iterable
from pathlib import Path

from fricomp.adapters import JointAdapter
from fricomp.laws import FrictionLaw

from ..seed_study import Score, SeedStudy, score
from .calibrate import calibrate
from .motion.context import SweepContext
from .planning.settings import SweepSettings
from .request import CalibrationRequest
from .run_folder import RunFolder


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
        result = calibration.estimate.result
        scores += score(result, truth, seed)
        statuses.append(str(result.status))
    return SeedStudy(tuple(scores), tuple(statuses))
