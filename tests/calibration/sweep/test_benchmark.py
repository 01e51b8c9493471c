"""The whole calibration with its defaults, on the default joint."""

from pathlib import Path
from typing import NoReturn

import pytest

from fricomp.calibration.sweep import (
    CalibrationOptions,
    CalibrationRequest,
    RunFolder,
    Sweep,
    SweepContext,
    benchmark,
    channels_of,
)
from fricomp.calibration.sweep.benchmark import study_seeds
from fricomp.errors import SweepAborted
from fricomp.sim_bench.stand_in import DEFAULT_LAW, SimulatedJointAdapter, default_joint


def test_a_study_replaces_the_runs_of_an_earlier_one(
    context: SweepContext, request_of_a_short_run: CalibrationRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    earlier = RunFolder.create(tmp_path / "seed-0", request_of_a_short_run)
    with earlier.open_writer(context.metadata(), channels_of(context)) as writer:
        Sweep(context, writer, earlier.load_data()).prepare()
    assert earlier.load_data().blocks

    def begun(context: SweepContext, folder: RunFolder, options: CalibrationOptions) -> NoReturn:
        assert not folder.load_data().blocks
        raise SweepAborted("begun anew")

    monkeypatch.setattr(benchmark, "calibrate", begun)
    with pytest.raises(SweepAborted, match="begun anew"):
        study_seeds(lambda seed: SimulatedJointAdapter(default_joint(seed=seed)), DEFAULT_LAW, range(1), tmp_path)


@pytest.mark.slow
def test_every_parameter_is_within_two_per_cent_and_its_uncertainty_is_right(tmp_path: Path) -> None:
    study = study_seeds(lambda seed: SimulatedJointAdapter(default_joint(seed=seed)), DEFAULT_LAW, range(2), tmp_path)
    assert study.statuses == ("converged", "converged")
    assert len(study.names) == 8
    for name in study.names:
        assert study.mean_error(name) < 0.02
        assert all(abs(score.normalised) < 4.5 for score in study.of(name))
    assert study.coverage() >= 0.75
