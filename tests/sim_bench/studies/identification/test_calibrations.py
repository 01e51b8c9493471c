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
    SweepSettings,
    channels_of,
)
from fricomp.errors import SweepAborted
from fricomp.sim_bench.stand_in import SimulatedJointAdapter, default_joint
from fricomp.sim_bench.studies.identification import calibrations
from fricomp.sim_bench.studies.identification.calibrations import study_calibrations


def test_a_study_replaces_the_runs_of_an_earlier_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    request = CalibrationRequest("sim", settings=SweepSettings(warm_up=0.5, tare=1.0))
    earlier = RunFolder.create(tmp_path / "seed-0", request)
    with SimulatedJointAdapter(default_joint()) as adapter:
        context = SweepContext(adapter, 0, request.settings)
        with earlier.open_writer(context.metadata(), channels_of(context)) as writer:
            Sweep(context, writer, earlier.load_data()).prepare()
    assert earlier.load_data().blocks

    def begun(context: SweepContext, folder: RunFolder, options: CalibrationOptions) -> NoReturn:
        assert not folder.load_data().blocks
        raise SweepAborted("begun anew")

    monkeypatch.setattr(calibrations, "calibrate", begun)
    with pytest.raises(SweepAborted, match="begun anew"):
        study_calibrations(range(1), tmp_path)


@pytest.mark.slow
def test_every_parameter_is_within_two_per_cent_and_its_uncertainty_is_right(tmp_path: Path) -> None:
    study = study_calibrations(range(2), tmp_path)
    assert study.statuses == ("converged", "converged")
    assert len(study.names) == 8
    for name in study.names:
        assert study.mean_error(name) < 0.02
        assert all(abs(score.normalised) < 4.5 for score in study.of(name))
    assert study.coverage() >= 0.75
