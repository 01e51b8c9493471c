"""Calibrate, compensate, record, diagnose, compensate with what was found: the loop closes."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.calibration.sweep import SweepSettings
from fricomp.control import PositionController, ReferenceState
from fricomp.joint import JointFeedback
from fricomp.sim_bench.stand_in import SimulatedJointAdapter
from fricomp.sim_bench.studies.tracking.close_loop import close_loop
from fricomp.sim_bench.studies.tracking.vertical_joint import GravityController, MultiSine, vertical_joint

QUICK = SweepSettings(speed_count=8, dense_count=0, repeats=1, dwell=0.5, warm_up=2.0, breakaway_positions=0, tare=1.0)


@pytest.mark.slow
def test_compensation_with_the_diagnosed_model_tracks_far_better(tmp_path: Path) -> None:
    result = close_loop(tmp_path, bandwidths=(5.0,), recorded=20.0, sweep=QUICK)
    assert result.diagnosis.verdict == "missing_physics"
    assert {"load_coulomb", "cogging"} <= {effect.name for effect in result.diagnosis.effects}
    found = result.extended.law.parameters()
    assert found["load_coulomb.coefficient"] == pytest.approx(0.12, rel=0.1)
    assert found["cogging.order"] == pytest.approx(11.0, abs=0.1)
    none, stribeck, extended = (result.figures[5.0][method].rms for method in ("none", "stribeck", "extended"))
    assert extended < 0.5 * stribeck < 0.5 * none
    assert {"joint.xml", "calibrated.json", "extended.json", "recording.csv", "diagnosis.json"} <= {
        path.name for path in tmp_path.iterdir()
    }


def test_controller_knows_what_the_link_asks_for(tmp_path: Path) -> None:
    """At rest the load is what holds the link, and all of the controller's torque."""
    adapter = SimulatedJointAdapter(vertical_joint(tmp_path, position=0.7))
    controller, load, torque = GravityController(PositionController([0.0], [0.0], [0.1])), [0.0], [0.0]
    reference = ReferenceState(1)
    reference.position[0] = 0.7
    controller.load_into(load, JointFeedback(1), reference)
    feedback = JointFeedback(1)
    feedback.position[0], feedback.velocity[0] = 0.7, 0.0
    controller.torque_into(torque, feedback, reference)
    plant = adapter.stand_in.plant
    assert load[0] == pytest.approx(float(plant.data.qfrc_bias[0]))
    assert torque[0] == pytest.approx(load[0])


def test_motion_starts_at_rest_and_is_its_own_derivative() -> None:
    motion, state = MultiSine(((-1.2, 0.05), (0.4, 0.17))), ReferenceState(1)
    motion.sample(0.0, state)
    assert (state.position[0], state.velocity[0]) == (motion.start, 0.0)
    rows = []
    for time in (1.0, 1.0 + 1e-5):
        motion.sample(time, state)
        rows.append((state.position[0], state.velocity[0], state.acceleration[0]))
    assert (rows[1][0] - rows[0][0]) / 1e-5 == pytest.approx(rows[0][1], abs=1e-4)
    assert (rows[1][1] - rows[0][1]) / 1e-5 == pytest.approx(rows[0][2], abs=1e-4)
