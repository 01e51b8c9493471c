"""What a case is made of: the request, by name and seed."""

from dataclasses import dataclass

from fricomp.errors import DiagnosisError

from .effects import EFFECTS
from .excitation import EXCITATIONS
from .fault import FAULTS
from .joint import FAMILIES
from .plant import CORES
from .sensing import NOISES

# Wanted effect-to-noise ratios after the base refit.
STRENGTHS = {"0.1": 0.1, "0.2": 0.2, "0.5": 0.5, "1": 1.0, "2": 2.0, "5": 5.0, "clear": 8.0}

# What a spec can be made of, by the name of its field.
CHOICES: dict[str, tuple[str, ...]] = {
    "strength": tuple(STRENGTHS),
    "excitation": tuple(EXCITATIONS),
    "noise": NOISES,
    "core": tuple(CORES),
    "family": tuple(FAMILIES),
    "fault": tuple(FAULTS),
}


@dataclass(frozen=True)
class CaseSpec:
    """What a case is made of; the seed draws the rest.

    Attributes:
        seed: Of joint, motion, sensors and effects.
        effects: Names of `EFFECTS`; none for a case with nothing missing.
        strength: Key of `STRENGTHS`.
        excitation: Key of `EXCITATIONS`.
        duration: Of the recording [s].
        noise: One of `NOISES`, or drawn.
        core: Key of `CORES`, or drawn.
        family: Key of `FAMILIES`, or drawn.
        form: Name of the functional form of the first effect, or drawn.
        shifted: The user's simulation has the parameters wrong beside whatever is concealed.
        hidden: Load and temperature are not logged.
        fault: Key of `FAULTS`, or none.
    """

    seed: int
    effects: tuple[str, ...] = ()
    strength: str = "clear"
    excitation: str = "rich"
    duration: float = 60.0
    noise: str | None = None
    core: str | None = None
    family: str | None = None
    form: str | None = None
    shifted: bool = False
    hidden: bool = False
    fault: str | None = None

    def __post_init__(self) -> None:
        chosen = [(field, getattr(self, field)) for field in CHOICES]
        for what, value in (*chosen, *(("effect", name) for name in self.effects)):
            valid = CHOICES.get(what, tuple(EFFECTS))
            if value is not None and value not in valid:
                raise DiagnosisError(f"unknown {what} {value!r}: valid are {', '.join(valid)}")
        if not 5.0 <= self.duration <= 600.0:
            raise DiagnosisError(f"a case of {self.duration} s cannot be made: give 5 to 600 s")
