"""What comes of a flawed log: the right friction within its interval, a refusal that names a flaw, or neither."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.identify import MotionIdentification, identify_motion
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.calibration.motion.parts import read_motion_recording
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.errors import FricompError
from fricomp.recording import Recording

from .flaws import FLAWS, NAMED, put_into
from .good_log import COULOMB, INERTIA, VISCOUS, joint_log

_BIAS = 0.04
"""Part of the truth by which an interval may miss it."""
_INERTIA = 0.1
"""Part of the truth by which the inertia may be off."""
_SECONDS = 24.0
"""Of a log [s]."""
_RATES = (400.0, 500.0, 1000.0, 250.0)
"""Rates of the logs, in turns [Hz]."""

Outcome = Literal["right", "named", "refused", "wrong"]


@dataclass(frozen=True)
class Trial:
    """A flawed log and what came of it.

    Attributes:
        flaws: Names of its flaws.
        rate: Of the good log [Hz].
        seed: Of log and flaws.
        outcome: `right` and `named` are wanted; `refused` names no flaw, `wrong` is a usable model that is off.
        said: Figures or the refusal.
    """

    flaws: tuple[str, ...]
    rate: float
    seed: int
    outcome: Outcome
    said: str

    @property
    def is_good(self) -> bool:
        """Whether a user is well served by it."""
        return self.outcome in ("right", "named")


def list_cases(count: int, seed: int) -> Iterator[tuple[tuple[str, ...], float, int]]:
    """Flaws, rate and seed of so many logs: each flaw alone and each pair, over and over with other seeds and rates."""
    names = list(FLAWS)
    kinds = [(name,) for name in names] + list(combinations(names, 2))
    for number in range(count):
        turn = number // len(kinds)
        yield kinds[number % len(kinds)], _RATES[turn % len(_RATES)], seed + turn


def try_case(flaws: tuple[str, ...], rate: float, seed: int) -> Trial:
    """Make a log with these flaws and identify its friction."""
    outcome, said = judge_log(put_into(joint_log(_SECONDS, rate, seed), flaws, seed), flaws)
    return Trial(flaws, rate, seed, outcome, said)


def judge_log(log: Recording, flaws: tuple[str, ...]) -> tuple[Outcome, str]:
    """What comes of a log with these flaws, and figures or the refusal."""
    try:
        found = _identify(log)
    except FricompError as error:
        named = any(flaw in NAMED and NAMED[flaw] in str(error) for flaw in flaws)
        return ("named" if named else "refused"), str(error)
    doubt = find_doubt_in_status(found.friction.status, found.friction.message)
    if doubt is not None:
        return "refused", doubt
    wrong = _list_wrong(found)  # a flaw that is mended is as good as one that is named
    return ("wrong", "; ".join(wrong)) if wrong else ("right", "")


def _identify(log: Recording) -> MotionIdentification:
    recording = read_motion_recording(log).recording
    settings = choose_settings(recording)
    return identify_motion(sample_joint(recording, settings), settings, law="coulomb_viscous")


def _list_wrong(found: MotionIdentification) -> list[str]:
    """Parameters that are off by more than their intervals say."""
    wrong = []
    for name, truth in (("coulomb.coulomb_torque", COULOMB), ("viscous.viscous_coefficient", VISCOUS)):
        interval = found.friction.interval(name)
        if not interval.lower - _BIAS * truth <= truth <= interval.upper + _BIAS * truth:
            value = found.friction.parameters[name]
            wrong.append(f"{name} {value:.4g} ({interval.lower:.4g} to {interval.upper:.4g}), truth {truth:g}")
    if abs(found.rigid_body.inertia / INERTIA - 1.0) > _INERTIA:
        wrong.append(f"inertia {found.rigid_body.inertia:.4g}, truth {INERTIA:g}")
    return wrong
