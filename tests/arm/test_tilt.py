"""A base that is not level: gravity leans over, and joints that stand upright in the simulation feel it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from fricomp.arm import ArmExamination, examine_arm
from fricomp.arm.output.corrected_simulation import correct_simulation
from fricomp.arm.pruning import _drop_empty_lean, _drop_far_gain
from fricomp.arm.rigid.regressor import compute_regressor, compute_regressors
from fricomp.arm.rigid.simulated_arm import read_arm

from .moving_arm import JOINTS, record_arm, write_arm

_LEAN = (0.012, -0.007)
"""[rad] along x and y: two thirds of a degree."""


def _write_upright(folder: Path, gravity: str = "0 0 -9.81") -> Path:
    """The arm with its first axis upright, which feels no gravity where the base is level."""
    path = write_arm(folder)
    text = path.read_text().replace('name="shoulder" axis="0 1 0"', 'name="shoulder" axis="0 0 1"')
    path = folder / f"upright {gravity}.xml"
    path.write_text(text.replace("<worldbody>", f'<option gravity="{gravity}"/><worldbody>', 1))
    return path


@pytest.fixture(scope="module")
def level(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _write_upright(tmp_path_factory.mktemp("level"))


@pytest.fixture(scope="module")
def leaning(level: Path) -> ArmExamination:
    true = _write_upright(level.parent, f"{9.81 * _LEAN[0]} {9.81 * _LEAN[1]} -9.81")
    return examine_arm(record_arm(true, seed=1), level)


@pytest.mark.slow
def test_the_lean_of_gravity_is_found(leaning: ArmExamination) -> None:
    tilt = leaning.record.tilt
    assert tilt is not None
    for name, truth in zip("xy", _LEAN, strict=True):
        low, high = tilt[name].ci95
        assert low < truth < high
        assert high - low < 0.004
    assert any("The base is not level" in line for line in leaning.record.sentences)
    assert any("The base is not level" in line for line in leaning.record.summary)


def test_nothing_is_named_and_no_link_is_off_on_a_leaning_base(leaning: ArmExamination) -> None:
    assert all(joint.effects == () for joint in leaning.record.joints)
    assert all(link.state != "off" for link in leaning.record.links)


def test_a_lean_that_may_be_none_along_both_axes_is_none(leaning: ArmExamination) -> None:
    fit = leaning.answer.identification.fit
    assert _drop_empty_lean(fit) is None
    _, spread = fit.lean
    at = np.arange(fit.x.size)[-4:-2]
    for sizes, dropped in (((1.5, -1.5), True), ((1.5, -2.5), False)):
        x = fit.x.copy()
        x[at] = np.array(sizes) * spread
        less = _drop_empty_lean(replace(fit, x=x))
        assert (less is not None and not less.tilted) is dropped


def test_a_gain_of_all_torques_that_is_far_off_is_none(leaning: ArmExamination) -> None:
    """It stands for what was not found yet when it was taken in."""
    found = leaning.answer.identification
    for gain, dropped in ((1.7, True), (0.2, False)):
        x = found.fit.x.copy()
        x[-1] = gain
        less = _drop_far_gain(replace(found.fit, x=x, model=replace(found.fit.model, gain=True)), found.prior)
        assert (less is not None and not less.gain) is dropped
    assert _drop_far_gain(found.fit, found.prior) is None


def test_the_corrected_simulation_has_that_gravity(leaning: ArmExamination, level: Path, tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(correct_simulation(leaning.answer, level)[0])
    gravity = mujoco.MjModel.from_xml_path(str(path)).opt.gravity
    assert gravity[:2] == pytest.approx(9.81 * np.array(_LEAN), abs=0.02)
    assert np.linalg.norm(gravity) == pytest.approx(9.81, rel=1e-5)


def test_an_arm_on_a_level_base_has_no_tilt(level: Path) -> None:
    assert examine_arm(record_arm(level), level).record.tilt is None


@pytest.mark.parametrize("gravity", ["0 0 -9.81", "0 -9.81 0", "3 1 -8"])
def test_the_change_of_torques_with_the_direction_of_gravity_is_that_of_another_gravity(
    tmp_path: Path, gravity: str
) -> None:
    q, v, a = np.random.default_rng(0).normal(size=(3, 20, 3))
    one = read_arm(_write_upright(tmp_path, gravity), JOINTS)
    down, lean = one.gravity, compute_regressors(one, q, v, a).lean
    for k, (name, axis) in enumerate(one.level_axes.items()):
        assert axis @ down == pytest.approx(0.0, abs=1e-12)
        assert axis["xyz".index(name)] > 0.5
        there = down + 1e-3 * np.linalg.norm(down) * axis
        other = read_arm(_write_upright(tmp_path, " ".join(map(str, there.tolist()))), JOINTS)
        change = (compute_regressor(other, q, v, a) - compute_regressor(one, q, v, a)) / 1e-3
        own = change.reshape(20, 3, 3, 10)
        assert own[..., :4].reshape(20, 3, 12) == pytest.approx(lean[:, :, k], abs=1e-8)
        assert own[..., 4:] == pytest.approx(0.0, abs=1e-8)
