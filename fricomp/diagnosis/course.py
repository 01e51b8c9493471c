"""One run of the search and what is judged of it: from the base to the answer and the models that bear it out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from fricomp.evaluation.motion import find_band

from .delivery.models import Delivery
from .evidence.alias import measure_late_rival
from .evidence.case import Case
from .evidence.findings import Findings, collect_findings, prefer_simulation
from .inputs.given import Given
from .inputs.late_action import find_late_action
from .inputs.track import Track
from .joint.loading import build_tracks, has_low_rate
from .joint.observer import Observer
from .joint.settings import JOINT
from .joint.weak_form import estimate_rest_speed
from .samples.second_look import look_into_samples, remove_ripple
from .search.again.late_torque import measure_late_torque
from .search.preparation import Baseline, prepare
from .search.rounds import search_in_rounds
from .verdict.delivering import deliver, leave_out_worse
from .verdict.judging import Verdict, join_channels, judge, judge_beside
from .verdict.late_rival import choose_late, leaves_noise_alone
from .verdict.shared_effect import SimulationEffects

Progress = Callable[[str], None]


@dataclass(frozen=True)
class StageSettings:
    """How the stages are run.

    Attributes:
        nulls: Recordings with nothing missing that are simulated for weights and thresholds. The more there are, the
            better the threshold is known that 98 % of them stay below, and the longer a diagnosis takes.
        draws: Seed of their noise. It is the same for every recording and every user (common random numbers), so that
            chance does not decide between two answers to the same data.
        other_draws: Whole diagnoses by other noise that a thorough one is held against.
        resting: Rest speed of the observer over the slowest speed that counts as sliding. Below it a model that rests
            is led back to the recorded position; a larger part would lead slow sliding back as well.
        slow_bandwidth: Bandwidth of the observer [rad/s] for recordings below some 300 Hz, whose steps a faster one
            could not follow.
        noise_share: Part of the acceleration's power that may be noise of the encoder in a row. An inertia comes out
            too small by it, and a loop that answers the noise takes its share for the motion's.
        widest_row: Widest row [s], about that of slow recordings: a wider one holds a whole stroke.
    """

    nulls: int = 32
    draws: int = 0
    other_draws: int = 3
    resting: float = 0.6
    slow_bandwidth: float = 30.0
    noise_share: float = 0.01
    widest_row: float = 0.17


SETTINGS = StageSettings()


@dataclass(frozen=True)
class Course:
    """What one run of the stages goes by.

    Attributes:
        given: Recordings and what they are compared with.
        simulated: Effects that the simulation has itself; None where nobody looked for them.
        seed: Of the bands of the report's maps.
        progress: Called with a few words before each step; None to say nothing.
        draws: Seed of the nulls' noise.
    """

    given: Given
    simulated: SimulationEffects | None
    seed: int
    progress: Progress | None
    draws: int = SETTINGS.draws

    def tell(self, words: str) -> None:
        """Say what comes next."""
        if self.progress is not None:
            self.progress(words)

    def choose_base(self, acts_late: float = 0.0) -> Callable[..., Baseline]:
        """What fits the base to the recordings, with the torque acting so late [s]."""
        tracks = _build_tracks(self.given, acts_late)
        observer = _choose_observer(self.given, tracks)
        return partial(
            prepare, tracks, observer=observer, seed=self.draws, rigid=self.given.rigid, nulls=SETTINGS.nulls
        )


def conclude(
    course: Course, baseline: Baseline, base: Callable[..., Baseline]
) -> tuple[Findings, Verdict, Delivery | None]:
    """The answer to what was asked, from this base, with the models that are handed over."""
    answer = _answer(course, baseline, base)
    return hold_to_files(course, _weigh_late_action(course, answer))


def _answer(course: Course, baseline: Baseline, base: Callable[..., Baseline]) -> tuple[Findings, Verdict]:
    """Search from this base, and judge what is found."""
    given = course.given
    baseline, found = search_in_rounds(baseline, base, course.draws, course.tell)
    case = Case(given.recordings, baseline, found, given.rigid, given.friction, course.draws, course.seed)
    return _judge_case(course, case)


def _weigh_late_action(course: Course, answer: tuple[Findings, Verdict]) -> tuple[Findings, Verdict]:
    """Answer once more with the torque moved to where it may act, where the joint asks for that; keep what leaves less.

    From there the base may move it back, so that a lag which looks like a delay from afar is found as one; and a lag
    that is named may be a delay, as may what bends a base whose own delay is at its bound, where that takes no other
    names. Where the torque need not act late after all, the search has only begun elsewhere, and may name what it
    finds.
    """
    usual = -min(track.delays[0] for track in answer[0].case.baseline.problem.tracks)
    acts_late = find_late_action(course.given.recordings, usual) or measure_late_rival(answer[0].case.found)
    shows = acts_late > 0.0
    if not shows:
        lags = [one.parameters["time_constant"].value for one in answer[1].effects if one.name == "drive_lag"]
        if leaves_noise_alone(answer[1]) and not lags:
            return answer
        findings = answer[0]
        acts_late = measure_late_torque(findings.case.baseline, findings.chosen) or max(lags, default=0.0)
    if acts_late <= usual:
        return answer
    course.tell("searching with the torque where it acts")
    base = course.choose_base(acts_late)
    return choose_late(_answer(course, base(), base), answer, usual, shows=shows)


def _judge_case(course: Course, case: Case) -> tuple[Findings, Verdict]:
    """Collect the evidence, and judge it; once more beside a ripple that only the samples show.

    Such a ripple is louder than the rows tell, and hides from them what else is missing.
    """
    course.tell("confirming on held-out data")
    findings = collect_findings(prefer_simulation(case))
    verdict = judge(findings, look_into_samples(findings), course.simulated)
    if verdict.sample is None or not verdict.sample.waves:
        return findings, verdict
    course.tell("searching beside the ripple")
    given = course.given
    without = replace(given, recordings=remove_ripple(given.recordings, verdict.sample))
    base = replace(course, given=without).choose_base()
    baseline, found = search_in_rounds(base(), base, case.seed, course.tell)
    findings = collect_findings(prefer_simulation(replace(case, baseline=baseline, found=found)))
    return findings, judge_beside(findings, verdict.sample, course.simulated)


def hold_to_files(course: Course, answer: tuple[Findings, Verdict]) -> tuple[Findings, Verdict, Delivery | None]:
    """The answer with the models that are handed over with it; another one where these do not bear it out.

    What was read off the delay of the base stays named: the models have no part in it.
    """
    findings, verdict = answer
    delivery = deliver(findings, verdict, course.given.whole)
    while without := leave_out_worse(findings, verdict, delivery):
        late = [one for one in verdict.effects if one.name in verdict.read_off]
        findings, verdict = _judge_case(course, replace(findings.case, found=without))
        verdict = join_channels(verdict, late)
        delivery = deliver(findings, verdict, course.given.whole)
    return findings, verdict, delivery


def repeat_with_other_noise(course: Course) -> tuple[Verdict, ...]:
    """Conclude from the same recordings by nulls of other noise."""
    verdicts = []
    for draws in range(course.draws + 1, course.draws + 1 + SETTINGS.other_draws):
        other = replace(course, draws=draws)
        base = other.choose_base()
        verdicts.append(conclude(other, base(), base)[1])
    return tuple(verdicts)


def _build_tracks(given: Given, acts_late: float = 0.0) -> list[Track]:
    """The recordings on one grid, by their names, without the torque of a spring that the simulation has."""
    spring = None if given.rigid is None else given.rigid.spring
    tracks = build_tracks(given.recordings, given.loops, spring, acts_late, given.pasts)
    return [replace(track, name=name) for track, name in zip(tracks, given.names, strict=True)]


def _choose_observer(given: Given, tracks: Sequence[Track]) -> Observer:
    """An observer that knows rest from sliding, is slow where the recordings are, and follows no encoder's noise."""
    band = min(find_band(one, SETTINGS.noise_share) for one in given.recordings)
    width = min(max(JOINT.row_width, 1.0 / band), SETTINGS.widest_row)
    observer = Observer(rest_speed=SETTINGS.resting * estimate_rest_speed(tracks, width), width=width)
    fastest = SETTINGS.slow_bandwidth if has_low_rate(given.recordings) else observer.bandwidth
    return replace(observer, bandwidth=min(fastest, JOINT.settled / width))
