"""A position that is counted from another zero from some row on is one motion; others that jump are not."""

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording
from fricomp.recording.parts.parts import find_usable_parts
from fricomp.sim_bench.studies.logs.flaws import put_into
from fricomp.sim_bench.studies.logs.good_log import joint_log as good_log

from ..joint_log import joint_log


def set_zero(log: Recording, row: int, way: float) -> Recording:
    position = np.array(log.position)
    position[row:] += way
    return log.with_channels(position=position, position_reference=position + 0.01)


@pytest.mark.parametrize("way", [-1.1, 0.4])
@pytest.mark.parametrize("seed", [1, 2])
def test_what_is_before_a_new_zero_is_moved_to_it(way: float, seed: int) -> None:
    log = joint_log(20.0, 400.0, seed)
    usable = find_usable_parts(set_zero(log, 2400, way))
    assert usable.parts == (usable.kept,)
    assert usable.kept.position == pytest.approx(log.position + way, abs=2e-3)
    assert usable.kept.position_reference == pytest.approx(log.position + way + 0.01, abs=2e-3)
    assert any("its zero is set anew at 6 s" in sentence for sentence in usable.sentences)
    assert "jump" not in {finding.code for finding in check_recording(usable.kept)}
    said = next(one for one in check_recording(set_zero(log, 2400, way)) if one.code == "jump")
    assert "the zero of position is set anew" in said.message


def test_a_joint_that_has_moved_meanwhile_has_its_old_zero() -> None:
    log = joint_log(20.0, 400.0, 3)
    far = int(np.argmax(np.abs(log.torque[2500:3300] - log.torque[2399]))) + 2500
    lost = log.rows(np.r_[0:2400, far : len(log)])
    squeezed = lost.with_channels(time=np.arange(len(lost)) / 400.0)
    assert not any("set anew" in sentence for sentence in find_usable_parts(squeezed).sentences)


def test_a_stretch_of_zeros_of_which_one_end_is_a_smaller_jump_is_no_new_zero() -> None:
    """Rows that are held for four readings make fast motion of four steps, and hide the smaller end among them."""
    log = put_into(good_log(24.0, 400.0, 22), ("torn", "held"), 22)
    assert not any("set anew" in sentence for sentence in find_usable_parts(log).sentences)
