"""Friction and rotors that the simulation states otherwise than they are."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.arm import examine_arm
from fricomp.arm.rigid.simulated_arm import read_arm

from .moving_arm import JOINTS, record_arm, write_arm


def _state_friction(simulation: Path, coulomb: float, viscous: float) -> Path:
    """The simulation with friction of its shoulder."""
    path = simulation.with_name("stated.xml")
    text = simulation.read_text()
    path.write_text(text.replace('name="shoulder"', f'name="shoulder" frictionloss="{coulomb}" damping="{viscous}"'))
    return path


@pytest.mark.parametrize("viscous", [0.6, 1.5])
def test_what_the_simulation_states_of_friction_and_rotors_is_compared(tmp_path: Path, viscous: float) -> None:
    """The shoulder has 1.2 N·m, 0.6 N·m·s/rad and a rotor of 0.1 kg·m²."""
    recordings = record_arm(write_arm(tmp_path, rotors=(0.1, 0.05, 0.0)))
    stated = _state_friction(write_arm(tmp_path, rotors=(0.2, 0.05, 0.0)), 1.2, viscous)
    assert read_arm(stated, JOINTS).friction[0].tolist() == [1.2, viscous]
    record = examine_arm(recordings, stated).record
    assert record.joints[0].stated == {"coulomb": 1.2, "viscous": viscous, "rotor_inertia": 0.2}
    (told,) = (line for line in record.summary if line.startswith("The simulation states other numbers"))
    assert "shoulder rotor" in told
    assert told.endswith("for 0.2.")
    assert ("viscous friction" in told) == (viscous != 0.6)
    assert "Coulomb" not in told
    assert "elbow" not in told


def test_a_simulation_that_states_nothing_has_nothing_wrong(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    record = examine_arm(record_arm(simulation, duration=20.0), simulation).record
    assert all(joint.stated == {} for joint in record.joints)
    assert not any("states other numbers" in line for line in (*record.summary, *record.sentences))
