"""A bristle that fills the motion is found with its travel; friction without memory never passes for one."""

import numpy as np
import pytest

from fricomp.diagnosis.samples.soft_presliding import find_soft_presliding, simulate_bristle
from fricomp.laws import LuGre
from fricomp.recording import Recording, RecordingMetadata, find_public_data, read_public


def _pushed(distance: float, spring: float = 0.0) -> Recording:
    """A band brake that is moved to and fro by 25 mm, with a bristle of 9 kN."""
    t = np.arange(7000) / 1000.0
    q = 0.025 * np.sin(6.3 * t) * (1.0 + 0.2 * np.sin(1.1 * t))
    v = np.gradient(q, t)
    force = 9000.0 * simulate_bristle(q, distance) + 4000.0 * v + spring * q + 200.0
    force = force + 50.0 * np.random.default_rng(2).standard_normal(t.size)
    return Recording(time=t, position=q, torque=force, metadata=RecordingMetadata(motion="linear", torque_unit="N"))


def test_the_travel_of_a_soft_bristle_is_found() -> None:
    found = find_soft_presliding(_pushed(0.004))
    assert found is not None
    assert found.distance == pytest.approx(0.004, rel=0.1)
    assert found.level == pytest.approx(9000.0, rel=0.05)
    assert found.errors["presliding"] < 0.3 * found.errors["memoryless"]
    term = found.law.terms[0]
    assert isinstance(term, LuGre)
    assert term.sigma_0 == pytest.approx(9000.0 / 0.004, rel=0.15)


@pytest.mark.parametrize("spring", [0.0, 3e5])
def test_a_stiff_bristle_is_none_even_beside_a_spring(spring: float) -> None:
    assert find_soft_presliding(_pushed(2e-6, spring)) is None


@pytest.mark.slow
def test_a_real_band_brake_preslides_over_millimetres() -> None:
    if find_public_data("brfd-backlash") is None:
        pytest.skip("the public data of brfd-backlash are not here: set FRICOMP_DATA")
    found = find_soft_presliding(read_public("brfd-backlash/1hz_36lb")[0])
    assert found is not None
    assert 0.003 < found.distance < 0.008
    assert found.errors["presliding"] < 0.5 * found.errors["memoryless"]
