"""Figures over sealed arms, each with its target and interval."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from ..kit.figure import Figure, measure_coverage, measure_median, require_at_least, require_at_most
from .score import CLEAR, ArmScore, TrueEffect


class Concealed(NamedTuple):
    """One effect in the score of its arm."""

    score: ArmScore
    effect: TrueEffect


class JointOf(NamedTuple):
    """One joint in the score of its arm."""

    score: ArmScore
    joint: str


def list_concealed(scores: Sequence[ArmScore], least: float = 0.0) -> list[Concealed]:
    """All effects of at least this effect-to-noise ratio."""
    return [Concealed(score, one) for score in scores for one in score.truth if one.enr >= least]


def _fall(one: JointOf) -> float:
    before, after = one.score.errors[one.joint]
    return after / max(before, 1e-300)


def _cost(score: ArmScore) -> float:
    return score.processor_seconds


def _measure_seconds(of: str, scores: Sequence[ArmScore], most: float) -> Figure[Any]:
    """How long an arm of a kind takes, wanted below `most` [s]."""
    return measure_median(
        f"seconds of an arm {of}", f"≤ {most:g}", scores, lambda score: score.seconds, lambda value: value <= most
    )


def compute_figures(scores: Sequence[ArmScore]) -> list[Figure[Any]]:
    """All figures; those of effects are of the clear ones, in clusters of an arm."""
    clear = list_concealed(scores, CLEAR)
    healthy = [JointOf(score, joint) for score in scores for joint in score.healthy]
    joints = [JointOf(score, joint) for score in scores for joint in score.errors]

    def arm_of(one: Concealed | JointOf) -> str:
        return one.score.case

    return [
        require_at_least(
            "joint with the effect found", 0.97, clear, lambda one: one.score.is_found(one.effect), arm_of
        ),
        require_at_least("exact name", 0.88, clear, lambda one: one.score.is_exact(one.effect), arm_of),
        require_at_most(
            "a name in a healthy joint",
            0.01,
            healthy,
            lambda one: any(each.joint == one.joint for each in one.score.false_names),
            cluster=arm_of,
        ),
        require_at_least("whole arm right", 0.8, scores, lambda score: score.is_right),
        measure_coverage("intervals of links hold the truth", scores, lambda score: score.links, 0.93, 0.97),
        measure_coverage("intervals of friction hold the truth", scores, lambda score: score.friction, 0.93, 0.97),
        measure_median(
            "held-out error of a joint, in that of its simulation", "≤ 0.75", joints, _fall, lambda value: value <= 0.75
        ),
        _measure_seconds("without an effect", [score for score in scores if not score.truth], 60.0),
        _measure_seconds("with two effects", [score for score in scores if len(score.truth) > 1], 150.0),
        measure_median(
            "seconds of one core",
            "–",
            [score for score in scores if score.processor_seconds],
            _cost,
            lambda value: None,
        ),
        require_at_most("no answer", 0.0, scores, lambda score: bool(score.error)),
    ]
