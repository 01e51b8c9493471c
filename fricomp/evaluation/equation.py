"""A joint as its equation of motion: tau = J a + gravity + offset + friction, along a recording and on its own."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np

from fricomp.laws import (
    DynamicTerm,
    FloatArray,
    FrictionLaw,
    OperatingPoint,
    Parts,
    Term,
    TracedPoint,
    trace_step,
)
from fricomp.laws.expression import Symbol
from fricomp.laws.source import compile_python, print_python
from fricomp.model import JointDynamics

from .motion import MotionPart

_STEP = 1e-6  # of a velocity over the fastest one, by which the slope of a term with a memory is taken
_Found = TypeVar("_Found")
_COLUMNS = ("velocity", "position", "acceleration", "load_torque", "temperature", "normal_load")


class Along(NamedTuple):
    """A model along the recorded motion.

    Attributes:
        torque: That the motion takes [N·m]. Shape (n,).
        states: Of each term that has any, at every sample; each of shape (n_states, n).
    """

    torque: FloatArray
    states: tuple[FloatArray, ...]


class Resistance(NamedTuple):
    """What resists the motion, about a velocity. Arrays of one shape.

    Attributes:
        held: Whatever the direction of motion [N·m].
        dry: Level against the direction of motion, never negative [N·m].
        drag: Slope of what rises from rest with the velocity [N·m·s/rad].
        bristle: Torque of bristles at that velocity [N·m].
        slope: How that grows with the velocity [N·m·s/rad].
    """

    held: Any
    dry: Any
    drag: Any
    bristle: Any
    slope: Any


class TermMemory:
    """What the terms of a law last came to along a motion, by what that hangs on: another number in one of them leaves
    the others as they were. The oldest of more than so many are forgotten."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._found: dict[Hashable, object] = {}

    def recall(self, key: Hashable, compute: Callable[[], _Found]) -> _Found:
        """The result of `compute`, called only where it is not known for this key; keys are of one kind of result."""
        found = self._found.pop(key) if key in self._found else compute()
        self._found[key] = found
        while len(self._found) > self._most:
            del self._found[next(iter(self._found))]
        return found  # type: ignore[return-value]


@dataclass(frozen=True)
class JointEquation:
    """Friction law and rigid body of one joint.

    Attributes:
        law: Friction.
        dynamics: Inertia, gravity, offset, load.
    """

    law: FrictionLaw
    dynamics: JointDynamics

    @property
    def inertia(self) -> float:
        """J [kg·m²] or [kg]."""
        return self.dynamics.inertia

    def compute_point(
        self, position: Any, velocity: Any, acceleration: Any, channels: Mapping[str, Any]
    ) -> OperatingPoint:
        """What the terms draw on; the load is what the joint carries, where it was not recorded."""
        load = channels.get("load_torque")
        if load is None:
            load = self.dynamics.compute_load(position, acceleration)
        return OperatingPoint(
            velocity, position, acceleration, load, channels.get("normal_load"), channels.get("temperature")
        )

    def compute_rigid(self, position: Any) -> Any:
        """Gravity and offset [N·m]."""
        return self.dynamics.compute_gravity(position) + self.dynamics.offset

    def follow(self, part: MotionPart, rest_speed: float, memory: TermMemory | None = None) -> Along:
        """Torque along the recorded motion, and the states of the terms there.

        Dry friction of a resting joint takes what the drive gives, up to its level.

        Args:
            part: The motion.
            rest_speed: Speed below which the joint rests [rad/s] or [m/s].
            memory: Of what the terms came to along this very part; None to work all of them out.
        """
        body = self.dynamics
        gravity = body.compute_gravity(part.position, lambda: part.waves)
        load = part.channels.get("load_torque")
        carried = None if load is not None else (body.gravity_cosine, body.gravity_sine, body.load_inertia)
        load = gravity + body.load_inertia * part.acceleration if load is None else load
        channels = {**part.channels, "load_torque": load}
        point = self.compute_point(part.position, part.smooth_velocity, part.acceleration, channels)
        rigid = self.inertia * part.acceleration + (gravity + body.offset)
        steps = part.dt, rest_speed
        torque = recall_torque(part, body.torque_delay, memory)
        return follow_law(self.law, point, rigid, torque, steps, memory, carried)


def follow_law(
    law: FrictionLaw,
    point: OperatingPoint,
    rigid: FloatArray,
    torque: FloatArray,
    steps: tuple[float, float],
    memory: TermMemory | None = None,
    carried: tuple[float, ...] | None = None,
) -> Along:
    """Torque of a rigid body with this friction along a motion.

    Args:
        law: Friction.
        point: The motion; each array of shape (n,).
        rigid: Torque of the rigid body there [N·m].
        torque: That acted at the samples: a resting joint takes it, up to the level of its dry friction [N·m].
        steps: Time between samples [s], and the speed below which the joint rests [rad/s] or [m/s].
        memory: Of what the terms came to along the same motion; None to work all of them out.
        carried: Numbers on which the load hangs there; None for a recorded one.
    """
    (dt, rest_speed), v = steps, np.asarray(point.velocity)
    states, found = [], []
    for term in law.terms:
        work_out = partial(_follow_term, term, point, dt)
        parts, after = work_out() if memory is None else memory.recall((term, carried), work_out)
        found.append(parts)
        if after is not None:
            states.append(after)
    smooth = rigid + _add(found, "held") + _add(found, "drag") + _add(found, "bristle")
    dry = np.maximum(_add(found, "dry") + np.zeros_like(v), 0.0)
    held = np.clip(torque - smooth, -dry, dry)
    return Along(smooth + np.where(np.abs(v) > rest_speed, dry * np.sign(v), held), tuple(states))


def _follow_term(term: Term, point: OperatingPoint, dt: float) -> tuple[Parts, FloatArray | None]:
    """Torque of a term along a motion, and its states where it has any. Shape (n_states, n)."""
    if not isinstance(term, DynamicTerm):
        return term.parts(point), None
    after = _follow_states(term, point, dt)
    before = np.concatenate([np.zeros((after.shape[0], 1)), after[:, :-1]], axis=1)
    return term.parts_after(point, tuple(before), tuple(after), dt), after


def resist(
    law: FrictionLaw, point: OperatingPoint, states: Sequence[FloatArray], dt: float, scale: float | FloatArray
) -> Resistance:
    """What resists at a point, linear in the velocity over a step of `dt` [s].

    Args:
        law: Friction.
        point: Arrays of shape (m,).
        states: Of each term that has any, before the step. Each of shape (n_states, m).
        dt: Step [s].
        scale: Fastest velocity [rad/s] or [m/s].
    """
    moved = _move(point, _STEP * scale)
    static = [term.parts(moved) for term in law.terms if not isinstance(term, DynamicTerm)]
    here, there = (
        [_look_ahead(term, one, before, dt) for term, before in zip(list_dynamic(law), states, strict=True)]
        for one in (point, moved)
    )
    gap = moved.velocity - point.velocity
    following, slope = (np.maximum((_add(there, kind) - _add(here, kind)) / gap, 0.0) for kind in ("drag", "bristle"))
    remainder = _add(here, "drag") - following * point.velocity  # of a drag that follows a state
    return Resistance(
        held=_add([*static, *here], "held") + remainder,
        dry=np.maximum(_add([*static, *here], "dry"), 0.0),
        drag=np.maximum(_add(static, "drag") / moved.velocity, 0.0) + following,
        bristle=_add(here, "bristle"),
        slope=slope,
    )


def advance_states(
    law: FrictionLaw, point: OperatingPoint, states: Sequence[FloatArray], dt: float
) -> tuple[FloatArray, ...]:
    """The states after a step of `dt` [s] at `point`."""
    return tuple(
        np.stack(np.broadcast_arrays(*term.follow(point, tuple(before), dt)))
        for term, before in zip(list_dynamic(law), states, strict=True)
    )


def align_torque(part: MotionPart, delay: float) -> FloatArray:
    """The torque that acted at each sample, where the recorded one is late by `delay` [s]. Shape (n,)."""
    if delay == 0.0:
        return part.torque
    return np.interp(part.time + delay, part.time, part.torque)


def recall_torque(part: MotionPart, delay: float, memory: TermMemory | None) -> FloatArray:
    """The same, worked out only where the memory of this part has it not."""
    work_out = partial(align_torque, part, delay)
    return work_out() if memory is None else memory.recall(("torque", delay), work_out)


def list_dynamic(law: FrictionLaw) -> tuple[DynamicTerm, ...]:
    """Terms with states, in order."""
    return tuple(term for term in law.terms if isinstance(term, DynamicTerm))


def _move(point: OperatingPoint, step: float | FloatArray) -> OperatingPoint:
    """The point at a slightly higher speed, so that nothing rests."""
    v = np.asarray(point.velocity, dtype=np.float64)
    away = np.where(v >= 0.0, v + step, v - step)
    return replace(point, velocity=away)


def _look_ahead(term: DynamicTerm, point: OperatingPoint, before: FloatArray, dt: float) -> Parts:
    """Torque of a term at the end of a step at `point`."""
    old = tuple(before)
    return term.parts_after(point, old, term.follow(point, old, dt), dt)


def _add(found: Sequence[Parts], kind: str) -> Any:
    total: Any = 0.0
    for parts in found:
        value = getattr(parts, kind)
        total = total if value is None else total + value
    return total


def _follow_states(term: DynamicTerm, point: OperatingPoint, dt: float) -> FloatArray:
    """States of a term along a motion, from rest. Shape (n_states, n)."""
    line = _find_line(term, point, dt) if len(term.states) == 1 else None
    if line is None:
        return _follow_by_formula(term, point, dt)
    state, seen = 0.0, []
    for share, added in zip(*(each.tolist() for each in line), strict=True):
        state = share * state + added
        seen.append(state)
    return np.array([seen])


def _find_line(term: DynamicTerm, point: OperatingPoint, dt: float) -> tuple[FloatArray, FloatArray] | None:
    """What a step keeps of the state and what it adds, at each sample, where the one does not hang on the other, as for
    a bristle at a given velocity: the formula is then worked out for all samples at once. Shape (n,) each."""
    n = np.size(point.velocity)
    tried = (0.0, 1.0, -1.0, 0.37)
    none, one, back, part = (np.broadcast_to(term.follow(point, (np.full(n, z),), dt)[0], n) for z in tried)
    share = one - none
    size = 1e-12 * (1.0 + np.abs(none) + np.abs(one))
    straight = np.all(np.abs(back - none + share) <= size) and np.all(np.abs(part - none - 0.37 * share) <= size)
    return (share, none) if straight else None


def _follow_by_formula(term: DynamicTerm, point: OperatingPoint, dt: float) -> FloatArray:
    """States of a term along a motion, by its own formula compiled to plain floats: one sample follows from the one
    before. Shape (n_states, n)."""
    given = [name for name in _COLUMNS if getattr(point, name) is not None]
    missing = {name: None for name in ("temperature", "normal_load") if name not in given}
    step = trace_step(term, TracedPoint(**missing, unknown=()), Symbol("dt"))
    lines, texts = print_python(step.after, {"speed": "abs(velocity)", "is_forward": "(velocity >= 0.0)"})
    states = ", ".join(step.states)
    source = [
        f"def follow(rows, dt, {states}):",
        "    seen = []",
        f"    for {', '.join(given)} in rows:",
        *(f"        {line}" for line in lines),
        f"        {states}, = {', '.join(texts)},",
        f"        seen.append(({states},))",
        "    return seen",
    ]
    n = np.size(point.velocity)
    rows = zip(*(np.broadcast_to(getattr(point, name), n).tolist() for name in given), strict=True)
    found = compile_python(source, "follow")(rows, dt, *([0.0] * len(step.states)))
    return np.array(found, dtype=np.float64).T
