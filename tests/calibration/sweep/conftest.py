from collections.abc import Iterator
from pathlib import Path

import pytest

from fricomp.calibration.sweep import CalibrationOptions, CalibrationRequest, RunFolder, SweepContext, SweepSettings
from fricomp.calibration.sweep.estimate import IdentificationSettings
from fricomp.sim_bench.stand_in import SimulatedJointAdapter, default_joint

# A sweep of some seconds: enough to show that every part of it works.
SHORT = SweepSettings(
    speeds="0.01,0.03,0.05,0.08,0.3,1.5",
    repeats=1,
    dwell=0.4,
    warm_up=0.5,
    tare=1.0,
    breakaway_positions=1,
)
QUICK = CalibrationOptions(IdentificationSettings(method="least_squares"))


@pytest.fixture
def request_of_a_short_run() -> CalibrationRequest:
    return CalibrationRequest("sim", settings=SHORT, options=QUICK)


@pytest.fixture
def adapter() -> Iterator[SimulatedJointAdapter]:
    with SimulatedJointAdapter(default_joint(seed=3)) as opened:
        yield opened


@pytest.fixture
def context(adapter: SimulatedJointAdapter) -> SweepContext:
    return SweepContext(adapter, 0, SHORT)


@pytest.fixture
def folder(tmp_path: Path, request_of_a_short_run: CalibrationRequest) -> RunFolder:
    return RunFolder.create(tmp_path / "run", request_of_a_short_run)
