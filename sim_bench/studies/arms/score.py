"""What the examination of an arm said, beside what is true."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..kit.blind import BlindAnswer
from ..kit.interval import KnownInterval

CLEAR = 0.5
"""Effect-to-noise ratio from which an effect should be named."""


@dataclass(frozen=True)
class TrueEffect:
    """What is concealed in a joint: its name in the catalogue and its effect-to-noise ratio."""

    joint: str
    name: str
    enr: float


@dataclass(frozen=True)
class NamedEffect:
    """What was named in a joint, with the names that it cannot be told from."""

    joint: str
    name: str
    others: tuple[str, ...] = ()

    def means(self, effect: TrueEffect) -> bool:
        """Whether this is that effect."""
        return self.joint == effect.joint and effect.name in (self.name, *self.others)


@dataclass(frozen=True)
class ArmScore:
    """One arm.

    Attributes:
        case: Name of the arm.
        seed: That made it.
        truth: What is concealed.
        named: What was said.
        links: Numbers of links that the motion determines.
        friction: Coulomb and viscous friction of joints without an effect.
        errors: Held-out errors of each joint: of the simulation, and of the model.
        seconds: Of the whole command [s].
        processor_seconds: Of one core that it took [s]; other work on the machine makes only `seconds` longer.
        error: Why there is no answer; empty where there is one.
    """

    case: str
    seed: int
    truth: tuple[TrueEffect, ...]
    named: tuple[NamedEffect, ...]
    links: tuple[KnownInterval, ...]
    friction: tuple[KnownInterval, ...]
    errors: Mapping[str, tuple[float, float]]
    seconds: float
    error: str = ""
    processor_seconds: float = 0.0

    def is_found(self, effect: TrueEffect) -> bool:
        """Whether something is named in the joint of an effect."""
        return any(one.joint == effect.joint for one in self.named)

    def is_exact(self, effect: TrueEffect) -> bool:
        """Whether what is named in the joint of an effect is what is concealed there, nothing beside it."""
        true = [one for one in self.truth if one.joint == effect.joint]
        said = [one for one in self.named if one.joint == effect.joint]
        return len(true) == len(said) and all(any(one.means(each) for one in said) for each in true)

    @property
    def healthy(self) -> tuple[str, ...]:
        """Joints without an effect."""
        return tuple(joint for joint in self.errors if all(one.joint != joint for one in self.truth))

    @property
    def false_names(self) -> tuple[NamedEffect, ...]:
        """Names in healthy joints."""
        return tuple(one for one in self.named if all(one.joint != each.joint for each in self.truth))

    @property
    def is_right(self) -> bool:
        """Whether all names are right, and all clear effects named."""
        clear = all(self.is_exact(one) for one in self.truth if one.enr >= CLEAR)
        return clear and not self.error and all(any(one.means(each) for each in self.truth) for one in self.named)


def score_arm(answer: bytes, blind: BlindAnswer) -> ArmScore:
    """Compare what was said with the answer."""
    true = json.loads(answer)
    said: dict[str, Any] = json.loads(blind.diagnosis) if blind.diagnosis else {"joints": [], "links": []}
    effects = tuple(TrueEffect(one["joint"], one["name"], one["enr"]) for one in true["effects"])
    named = tuple(
        NamedEffect(joint["name"], one["name"], tuple(one.get("indistinguishable_from", ())))
        for joint in said["joints"]
        for one in joint["effects"]
    )
    touched = {one.joint for one in effects}
    return ArmScore(
        case=true["id"],
        seed=true["spec"]["seed"],
        truth=effects,
        named=named,
        links=tuple(each for link in said["links"] for each in _compare_link(link, true["links"][link["name"]])),
        friction=tuple(
            each
            for joint in said["joints"]
            if joint["name"] not in touched
            for each in _compare_friction(joint, true["friction"][joint["name"]])
        ),
        errors={joint["name"]: (joint["error_simulation"], joint["error_model"]) for joint in said["joints"]},
        seconds=blind.seconds,
        error=blind.error,
        processor_seconds=blind.processor_seconds,
    )


def _compare_link(link: Mapping[str, Any], truth: Mapping[str, float]) -> list[KnownInterval]:
    given = {"mass": link["mass"], **link["first_moment"]}
    return [_compare(link["name"], name, given[name], truth[name]) for name in link["determined"]]


def _compare_friction(joint: Mapping[str, Any], truth: Mapping[str, float]) -> list[KnownInterval]:
    level = 0.5 * (truth["coulomb_forward"] + truth["coulomb_reverse"])
    pairs = (("coulomb", level), ("viscous", truth["viscous"]))
    return [_compare(joint["name"], name, joint["friction"][name], value) for name, value in pairs]


def _compare(of: str, name: str, given: Mapping[str, Any], truth: float) -> KnownInterval:
    return KnownInterval(of, name, truth, given["value"], *given["ci95"])
