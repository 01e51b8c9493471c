"""Which joints are recorded, on which motions, with which sensors and seeds."""

from collections.abc import Sequence
from dataclasses import dataclass

from fricomp.errors import DiagnosisError

from .effect import Effect
from .effects import EFFECTS
from .forms import FORMS
from .motion import MOTIONS

_DURATION, _QUICK = 60.0, 20.0  # [s]
_NULL_SEEDS = {True: (1, 2, 3), False: (4, 5, 6)}  # with a velocity and without: no joint counts twice
_WITHOUT_VELOCITY = ("load_coulomb", "cogging", "joint_elasticity", "drive_lag", "memory_spring")


@dataclass(frozen=True)
class Case:
    """One recording.

    Attributes:
        effect: Name of what the simulation leaves out.
        motion: Name of the motion.
        seed: Of motion and noise.
        velocity: The loop's filtered velocity is recorded.
        duration: [s]
    """

    effect: str
    motion: str
    seed: int
    velocity: bool = True
    duration: float = _DURATION

    @property
    def name(self) -> str:
        """Also that of the folder."""
        parts = [self.effect, self.motion]
        parts += [str(self.seed)] if self.effect == "nothing" else []
        parts += [] if self.velocity else ["no-velocity"]
        return "-".join(parts)

    @property
    def truth(self) -> Effect:
        """What the simulation leaves out."""
        return EFFECTS[self.effect]


def list_cases(*, quick: bool = False) -> list[Case]:
    """All cases, joints with nothing missing first.

    Args:
        quick: Recordings of 20 s in place of 60 s.
    """
    duration = _QUICK if quick else _DURATION
    cases = [
        Case("nothing", motion, seed, velocity, duration)
        for velocity in (True, False)
        for motion in MOTIONS
        for seed in _NULL_SEEDS[velocity]
    ]
    # Each effect has a seed of its own, so that no two are recorded on one motion.
    seeds = {name: 10 * number for number, name in enumerate(EFFECTS) if name != "nothing"}
    forms = {form.name for form in FORMS}  # on the motion that shows most, one diagnosis each
    for name, seed in seeds.items():
        motions = ("rich",) if name in forms else MOTIONS
        cases += [Case(name, motion, seed + k, True, duration) for k, motion in enumerate(motions)]
    cases += [Case(name, "rich", seeds[name] + 2, False, duration) for name in _WITHOUT_VELOCITY]
    return cases


def choose_cases(only: Sequence[str], *, quick: bool = False) -> list[Case]:
    """The cases with these names, or of the effects with these names; all for none.

    Raises:
        DiagnosisError: There is no such case or effect.
    """
    cases = list_cases(quick=quick)
    for name in only:
        if not any(name in (case.name, case.effect) for case in cases):
            raise DiagnosisError(
                f"no case or effect {name!r}: valid are the effects {', '.join(EFFECTS)}, "
                f"and cases such as {cases[0].name} and {cases[-1].name}"
            )
    return [case for case in cases if not only or case.name in only or case.effect in only]
