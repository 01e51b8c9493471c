"""Which cases a proof consists of: groups in fixed shares, interleaved so that any beginning is a fair sample.

Motions, friction cores and noises are drawn from shuffled decks, so that every effect meets all of them: lists that
turn side by side meet in the same pairs for ever where their lengths share a divisor.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle, islice
from typing import Any

import numpy as np

from ...cases import CATALOGUE, CHOICES, OUTSIDE, CaseSpec
from ..real.injection import InjectedSpec

# Share of each group. Of 2,000 cases 540 have nothing missing, 220 are pairs and 140 lie outside the catalogue.
GROUPS = {
    "single": 0.50,
    "null": 0.17,
    "hard_null": 0.10,
    "pair": 0.11,
    "outside": 0.07,
    "triple": 0.01,
    "hidden": 0.02,
    "fault": 0.02,
}
NULLS = ("null", "hard_null")
"""Groups in which nothing is missing."""

_SHORT = 30.0
"""Length of the recordings of clear cases [s]."""

_ONE_SPRING = {"joint_elasticity", "backlash"}
"""Both are of the one transmission, which has one stiffness, so that they do not go together."""

_STRENGTHS = ("1", "0.5", "2", "0.2", "5", "0.1", "clear")
_MOTIONS = ("rich", "fourier", "rich", "sweep", "rich", "fourier", "pick_and_place", "rich", "slow_reversals", "chirp")
_HIDDEN = ("load_coulomb", "thermal_friction", "load_stribeck", "load_quadratic")
_PARAMETERS = ("inertia_error", "payload_error", "torque_offset", "direction_asymmetry")
_OF_THE_BODY = frozenset({"inertia_error", "payload_error", "torque_gain_error"})
"""What is known by the simulation's inertia and gravity alone: where those are wrong as well, nobody can tell."""

_LAWLESS = ("external_disturbance", "neighbour_coupling")
"""Pushes and neighbours that are not logged: beside another effect nobody can name them."""


@dataclass(frozen=True)
class PlannedCase:
    """One case of a proof.

    Attributes:
        group: Key of `GROUPS`, or `injected` and `injected_null` for real recordings.
        spec: What to make.
    """

    group: str
    spec: CaseSpec | InjectedSpec


def plan_cases(
    count: int,
    seeds: Iterator[int],
    duration: float | None = None,
    groups: Collection[str] = tuple(GROUPS),
    order: int = 0,
) -> list[PlannedCase]:
    """The first `count` cases over these seeds.

    Args:
        count: How many.
        seeds: One is taken for each case.
        duration: Of every recording [s]; by default mostly 60, some 30 or 120.
        groups: Keys of `GROUPS`; cases of others are left out.
        order: In which designs (effects, motions, cores, noises) follow each other; every number has its own.
    """
    makers = {group: _open_maker(group, order) for group in GROUPS}
    planned = []
    for group in islice((group for group in _interleave() if group in groups), count):
        fields = next(makers[group])
        length = duration or (60.0 if fields["excitation"] == "fourier" else fields.pop("duration", 60.0))
        fields.pop("duration", None)
        planned.append(PlannedCase(group, CaseSpec(seed=next(seeds), duration=length, **fields)))
    return planned


def plan_clear_cases(seeds: Iterator[int]) -> list[PlannedCase]:
    """Every effect of the catalogue once, clear, on a rich motion, and a case with nothing missing after every third.

    Args:
        seeds: One is taken for each case.
    """
    rng = np.random.default_rng(9)
    decks = (CHOICES["core"], CHOICES["core"], CHOICES["noise"], _MOTIONS[1:])
    cores, null_cores, noises, motions = (_shuffle(rng, cards) for cards in decks)
    planned = []
    for index, name in enumerate(CATALOGUE, start=1):
        single = CaseSpec(next(seeds), (name,), "clear", "rich", _SHORT, next(noises), next(cores))
        planned.append(PlannedCase("single", single))
        if index % 3 == 0:
            nothing = CaseSpec(next(seeds), (), "clear", next(motions), _SHORT, next(noises), next(null_cores))
            planned.append(PlannedCase("null", nothing))
    return planned


def _open_maker(group: str, order: int) -> Iterator[dict[str, Any]]:
    """Designs of a group without end."""
    return _MAKERS[group](np.random.default_rng([8, list(GROUPS).index(group), order]))


def _shuffle(rng: np.random.Generator, cards: Sequence[str]) -> Iterator[str]:
    """All cards in an order of its own, again and again."""
    while True:
        yield from (cards[place] for place in rng.permutation(len(cards)))


def _interleave() -> Iterator[str]:
    """Groups in their shares, each as early as its share allows."""
    owed = dict.fromkeys(GROUPS, 0.0)
    while True:
        for group, share in GROUPS.items():
            owed[group] += share
        group = max(owed, key=lambda name: owed[name])
        owed[group] -= 1.0
        yield group


def _draw_settings(rng: np.random.Generator, shifted: bool = True) -> Iterator[dict[str, Any]]:
    """Motions, noises, cores, families and lengths, each drawn by itself; an effect that has its own meets them all.

    In every second case the user's simulation has inertia and gravity wrong, where that may be.
    """
    decks = {"excitation": _MOTIONS, "noise": CHOICES["noise"], "core": CHOICES["core"]}
    for drawn in zip(*(_shuffle(rng, cards) for cards in decks.values()), strict=True):
        yield {
            **dict(zip(decks, drawn, strict=True)),
            "family": CHOICES["family"][int(rng.random() < 0.4)],
            "duration": float(rng.choice([60.0, 60.0, 60.0, 30.0, 120.0])),
            "shifted": bool(rng.random() < 0.5) and shifted,
        }


def _plan_single(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    """Every effect of the catalogue in turn; strengths turn with the rounds, shifted from effect to effect."""
    names = tuple(map(str, rng.permutation(list(CATALOGUE))))
    own = {name: _draw_settings(rng, name not in _OF_THE_BODY) for name in names}
    for index in range(2**31):
        turn, place = divmod(index, len(names))
        name, strength = names[place], _STRENGTHS[(turn + place) % len(_STRENGTHS)]
        yield next(own[name]) | {"effects": (name,), "strength": strength}


def _plan_pair(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    return _plan_several(rng, 2)


def _plan_triple(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    return _plan_several(rng, 3)


def _plan_several(rng: np.random.Generator, number: int) -> Iterator[dict[str, Any]]:
    names = [name for name in CATALOGUE if name not in _PARAMETERS + _LAWLESS]
    for fields, strength in zip(_draw_settings(rng), cycle(("2", "1", "5", "clear", "0.5")), strict=False):
        drawn = rng.choice(names, number, replace=False)
        while set(drawn) >= _ONE_SPRING:
            drawn = rng.choice(names, number, replace=False)
        shifted = fields["shifted"] and not _OF_THE_BODY.intersection(drawn)
        design = {"effects": tuple(map(str, drawn)), "strength": strength, "excitation": "rich", "shifted": shifted}
        yield fields | design


def _plan_null(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    yield from _draw_settings(rng, shifted=False)


def _plan_hard_null(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    for fields in _draw_settings(rng):
        yield fields | {"shifted": True}


def _plan_outside(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    own = {name: _draw_settings(rng) for name in OUTSIDE}
    for name, strength in zip(cycle(OUTSIDE), cycle(("5", "clear", "2", "1", "clear")), strict=False):
        yield next(own[name]) | {"effects": (name,), "strength": strength}


def _plan_hidden(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    own = {name: _draw_settings(rng) for name in _HIDDEN}
    for name in cycle(_HIDDEN):
        yield next(own[name]) | {"effects": (name,), "strength": "5", "hidden": True}


def _plan_fault(rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    for fields, name in zip(_draw_settings(rng), cycle(CHOICES["fault"]), strict=False):
        yield fields | {"fault": name}


_MAKERS = {
    "single": _plan_single,
    "null": _plan_null,
    "hard_null": _plan_hard_null,
    "pair": _plan_pair,
    "outside": _plan_outside,
    "triple": _plan_triple,
    "hidden": _plan_hidden,
    "fault": _plan_fault,
}
