"""What a diagnosis said of one case, beside what is true."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..proof.blind import BlindAnswer
from ..proof.score import PARAMETERS, read_diagnosis
from .cases import Case
from .effect import Group
from .record import FILTER_LAG

__all__ = ["KnownValue", "Score", "score_case"]

_LAG = "velocity_filter_lag"
_VERDICTS: dict[Group, tuple[str, ...]] = {
    "nothing": ("consistent",),
    "parameter": ("parameters",),
    "measurement": ("measurement",),
    "physics": ("missing_physics",),
    "outside": ("unknown_physics",),
}


@dataclass(frozen=True)
class KnownValue:
    """A parameter whose true value is known, as the diagnosis gives it, in SI.

    Attributes:
        effect: That it belongs to.
        name: Of the parameter.
        truth: True value.
        value: As given.
        low: Lower end of its 95 % interval.
        high: Upper end.
    """

    effect: str
    name: str
    truth: float
    value: float
    low: float
    high: float

    @property
    def covered(self) -> bool:
        """Whether the interval holds the truth."""
        return self.low <= self.truth <= self.high


@dataclass(frozen=True)
class Score:
    """One row of the results.

    Attributes:
        case: Which.
        verdict: As given; `failed` where there is none.
        named: Effects, strongest first.
        sets: What each of them cannot be told from.
        values: Known parameters of the effect and of the velocity's filter.
        before: Held-out error of the base model [N·m]; None where there is none.
        after: With what was named [N·m].
        floor: The diagnosis' own estimate of the noise [N·m].
        seconds: Wall-clock time of the diagnosis [s].
        error: Why there is no answer; empty where there is one.
        diagnosis: Version of the diagnosis that answered.
    """

    case: Case
    verdict: str
    named: tuple[str, ...]
    sets: tuple[tuple[str, ...], ...]
    values: tuple[KnownValue, ...] = ()
    before: float | None = None
    after: float | None = None
    floor: float | None = None
    seconds: float = 0.0
    error: str = ""
    diagnosis: str = ""

    @property
    def group(self) -> Group:
        """What the simulation of the case leaves out."""
        return self.case.truth.group

    @property
    def hidden(self) -> bool:
        """Whether there is an effect of the catalogue to find."""
        return self.group in ("parameter", "measurement", "physics")

    @property
    def judged(self) -> tuple[str, ...]:
        """Names, strongest first, but for those that are right in any case: the filter of a recorded velocity."""
        return tuple(name for name in self.named if not (name == _LAG and self.case.velocity))

    @property
    def first_right(self) -> bool:
        """Whether the strongest name is right, or printed as what cannot be told from a right one."""
        return bool(self.judged) and self._is_right(self.judged[0])

    @property
    def found(self) -> bool:
        """Whether any name or its set is right."""
        return any(self._is_right(name) for name in self.judged)

    @property
    def false_names(self) -> tuple[str, ...]:
        """Names that are not right and do not come with a right one in their set."""
        return tuple(name for name in self.judged if not self._is_right(name))

    @property
    def false_beyond_parameters(self) -> tuple[str, ...]:
        """Those that are more than a parameter of the simulation, as the proof counts them."""
        return tuple(name for name in self.false_names if name not in PARAMETERS)

    @property
    def filter_named(self) -> bool:
        """Whether the filter of the recorded velocity is named."""
        return self.case.velocity and _LAG in self.named

    @property
    def expected(self) -> tuple[str, ...]:
        """Right verdicts; the filter of a recorded velocity makes `measurement` of those that are no graver."""
        verdicts = _VERDICTS[self.group]
        graver = self.group in ("physics", "outside")
        return verdicts if graver or not self.filter_named else ("measurement",)

    @property
    def verdict_right(self) -> bool:
        """Whether the verdict is one of those."""
        return self.verdict in self.expected

    @property
    def wrong(self) -> bool:
        """No answer, a wrong verdict, a false name, or an effect of the catalogue that was not found first."""
        return not self.verdict_right or bool(self.false_names) or (self.hidden and not self.first_right)

    def _is_right(self, name: str) -> bool:
        group = {name, *self.sets[self.named.index(name)]}
        return bool(group & self.case.truth.names)


def score_case(case: Case, truth: dict[str, float], blind: BlindAnswer) -> Score:
    """Compare an answer with the truth.

    Args:
        case: Which.
        truth: Known parameters of its effect.
        blind: What came back from the diagnosis.

    Raises:
        DiagnosisError: The diagnosis is of another schema.
    """
    said = read_diagnosis(blind.diagnosis)
    heldout = said.get("heldout") or {}
    return Score(
        case=case,
        verdict=said["verdict"],
        named=tuple(each["name"] for each in said["effects"]),
        sets=tuple(tuple(each.get("indistinguishable_from", ())) for each in said["effects"]),
        values=_known_values(case, truth, said),
        before=heldout.get("rmse_before"),
        after=heldout.get("rmse_after"),
        floor=heldout.get("noise_floor"),
        seconds=blind.seconds,
        error=blind.error,
    )


def _known_values(case: Case, truth: dict[str, float], said: dict[str, Any]) -> tuple[KnownValue, ...]:
    """Of the effects that are named; a parameter that the diagnosis holds fixed has no interval and is left out."""
    known = {case.effect: truth, _LAG: {"time_constant": FILTER_LAG} if case.velocity else {}}
    values = []
    for each in said["effects"]:
        for name, true in known.get(each["name"], {}).items():
            given = each["parameters"].get(name)
            if given is not None and given["ci95"][0] < given["ci95"][1]:
                values.append(KnownValue(each["name"], name, true, given["value"], *given["ci95"]))
    return tuple(values)
