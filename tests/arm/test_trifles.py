"""Without noise anything is sure: what nobody would notice is neither named nor off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import ArmRecord, examine_arm
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm


def _examine_wave(folder: Path, amplitude: float) -> ArmRecord:
    """The record of an arm without noise whose wrist, of 0.3 N·m of friction, has a wave of torque [N·m]."""
    simulation = write_arm(folder)

    def wave(joint: int, q: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
        return amplitude * np.sin(12.0 * q) if joint == 2 else np.zeros_like(q)

    return examine_arm(record_arm(simulation, wave, noise=0.0), simulation).record


@pytest.mark.parametrize(("amplitude", "named"), [(0.0022, False), (0.004, True)])
def test_an_effect_is_named_from_half_a_per_cent_of_the_friction_on(
    tmp_path: Path, amplitude: float, named: bool
) -> None:
    record = _examine_wave(tmp_path, amplitude)
    assert [effect.name for joint in record.joints for effect in joint.effects] == ["cogging"] * named
    assert not any(link.state == "off" for link in record.links)


def test_an_order_is_moved_to_where_its_wave_fits_best(tmp_path: Path) -> None:
    """Read off what a plain fit leaves it was beside the truth, and what comes of that was named as a spring."""
    simulation = write_arm(tmp_path)

    def wave(joint: int, q: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
        return 1.5 * np.sin(23.37 * q) if joint == 0 else np.zeros_like(q)

    record = examine_arm(record_arm(simulation, wave, noise=0.01), simulation).record
    assert [effect.name for joint in record.joints for effect in joint.effects] == ["cogging"]
    (effect,) = record.joints[0].effects
    assert effect.parameters["order"].value == pytest.approx(23.37, abs=0.005)
    assert np.hypot(effect.parameters["cosine"].value, effect.parameters["sine"].value) == pytest.approx(1.5, rel=0.01)
