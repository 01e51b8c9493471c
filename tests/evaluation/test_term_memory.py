"""Terms along a motion are worked out once for each set of their own numbers, and come to the same."""

import numpy as np

from fricomp.evaluation import read_motion
from fricomp.evaluation.equation import JointEquation, TermMemory
from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, LoadCoulomb, LuGre, StribeckCurve, Term
from fricomp.model import JointDynamics
from fricomp.recording import Recording

_SIDE = StribeckCurve(0.3, 0.4, 0.06, 0.1)
_CURVES = BidirectionalStribeck(_SIDE, _SIDE)


def test_a_result_is_worked_out_once_and_the_oldest_is_forgotten() -> None:
    asked: list[str] = []
    memory = TermMemory(2)

    def work_out(key: str) -> str:
        asked.append(key)
        return key

    assert [memory.recall(key, lambda key=key: work_out(key)) for key in "abacab"] == list("abacab")  # type: ignore[misc]
    assert asked == ["a", "b", "c", "b"]


def test_a_model_follows_a_motion_to_the_same_torque_with_a_memory_of_others() -> None:
    """Of other numbers in its own terms, another gravity, which changes the load, and another delay."""
    t = np.arange(1500, dtype=np.float64) * np.float64(4e-3)
    q = np.sin(1.3 * t) + 0.2 * np.sin(5.0 * t)
    torque = 0.3 * np.sign(np.gradient(q)) + np.random.default_rng(1).normal(0.0, 0.01, t.size)
    motion = read_motion(Recording(t, q, torque))
    memory = TermMemory(20)
    bristle = LuGre(_SIDE, _SIDE, sigma_0=50.0, sigma_1=0.1)
    laws: list[tuple[Term, ...]] = [
        (_CURVES, Cogging(0.1, 0.0, 9.0), LoadCoulomb(0.2)),
        (_CURVES, Cogging(0.2, 0.0, 9.0), LoadCoulomb(0.2)),
        (bristle, LoadCoulomb(0.2)),
        (bristle, LoadCoulomb(0.1)),
    ]
    for terms in laws:
        for gravity, delay in ((0.5, 0.0), (0.7, 0.0), (0.7, 0.002), (0.5, 0.0)):
            equation = JointEquation(FrictionLaw(terms), JointDynamics(0.1, gravity, 0.1, torque_delay=delay))
            fresh, recalled = (equation.follow(motion.parts[0], motion.rest_speed, one) for one in (None, memory))
            np.testing.assert_array_equal(recalled.torque, fresh.torque)
            assert len(recalled.states) == len(fresh.states)
