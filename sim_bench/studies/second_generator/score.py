"""What a diagnosis said of one case, beside what is true."""

from dataclasses import dataclass
from typing import Any

from ..kit.belief import Belief, list_beliefs
from ..kit.blind import BlindAnswer
from ..kit.interval import KnownInterval, compare_parameters
from ..kit.score import JudgedNames, judge_names, read_diagnosis
from .cases import Case
from .effect import Group
from .record import FILTER_LAG

_LAG = "velocity_filter_lag"
_VERDICTS: dict[Group, tuple[str, ...]] = {
    "nothing": ("consistent",),
    "parameter": ("parameters",),
    "measurement": ("measurement",),
    "physics": ("missing_physics",),
    "outside": ("unknown_physics",),
}


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
        beliefs: Probabilities of the answer, beside what is true.
    """

    case: Case
    verdict: str
    named: tuple[str, ...]
    sets: tuple[tuple[str, ...], ...]
    values: tuple[KnownInterval, ...] = ()
    before: float | None = None
    after: float | None = None
    floor: float | None = None
    seconds: float = 0.0
    error: str = ""
    beliefs: tuple[Belief, ...] = ()

    @property
    def group(self) -> Group:
        """What the simulation of the case leaves out."""
        return self.case.truth.group

    @property
    def hidden(self) -> bool:
        """Whether there is an effect of the catalogue to find."""
        return self.group in ("parameter", "measurement", "physics")

    @property
    def judged(self) -> JudgedNames:
        """The names that count; the filter of a recorded velocity is true in any case."""
        sets = {name: frozenset({name, *others}) for name, others in zip(self.named, self.sets, strict=True)}
        return judge_names(sets, self.case.truth.names, (_LAG,) if self.case.velocity else ())

    @property
    def first_right(self) -> bool:
        """Whether the strongest name is right, or printed as what cannot be told from a right one."""
        return self.judged.first_set_is_right

    @property
    def found(self) -> bool:
        """Whether any name or its set is right."""
        return len(self.judged.false_names) < len(self.judged.sets)

    @property
    def false_names(self) -> tuple[str, ...]:
        """Names that are not right and do not come with a right one in their set."""
        return self.judged.false_names

    @property
    def false_beyond_parameters(self) -> tuple[str, ...]:
        """Those that are more than a parameter of the simulation."""
        return tuple(name for name in self.false_names if name not in self.judged.false_parameters)

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
        values=_compare_values(case, truth, said),
        before=heldout.get("rmse_before"),
        after=heldout.get("rmse_after"),
        floor=heldout.get("noise_floor"),
        seconds=blind.seconds,
        error=blind.error,
        beliefs=list_beliefs(
            said, {*case.truth.names, *((_LAG,) if case.velocity else ())}, _VERDICTS[case.truth.group][0]
        ),
    )


def _compare_values(case: Case, truth: dict[str, float], said: dict[str, Any]) -> tuple[KnownInterval, ...]:
    """Parameters of the effects that are named."""
    known = {case.truth.called: truth, _LAG: {"time_constant": FILTER_LAG} if case.velocity else {}}
    return tuple(
        value
        for each in said["effects"]
        for value in compare_parameters(each["name"], each["parameters"], known.get(each["name"], {}))
    )
