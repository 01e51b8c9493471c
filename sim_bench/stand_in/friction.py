"""A friction law turned into what MuJoCo can hold still: a bound on the dry torque, plus torques applied outright.

MuJoCo's `dof_frictionloss` L is a constraint force anywhere in [-L, L] that brings the end-of-step velocity to zero
if it can: true sticking. A law is therefore split, at the joint's present state, into

- the level: its dry and dragging parts against the direction of motion;
- the offset: parts such as cogging that do not depend on the direction, applied as an outside torque;
- the torque of bristles (Dahl, LuGre), likewise applied, and what drags by a state beside a dry level with a memory.

The level is taken at the end-of-step speed, linearised in it: rising branches, however steep, cannot overshoot. The
formulas are those of the terms, compiled once for a law.
"""

from collections.abc import Sequence
from typing import Any

from fricomp.laws import (
    DynamicTerm,
    FrictionLaw,
    Parts,
    TracedPoint,
    TracedStep,
    find_inputs,
    trace_parts,
    trace_step,
)
from fricomp.laws.expression import Expression, Symbol, add_up, differentiate
from fricomp.laws.source import compile_python, print_python

__all__ = ["Contact", "JointFriction", "has_bristle"]

# Speed that stands for "just sliding" where the slope of a power has no bound at rest [rad/s] or [m/s].
CREEP = 1e-9


class Contact:
    """What friction depends on besides velocity; one object a joint, rewritten every step.

    Attributes:
        position: [rad] or [m].
        acceleration: [rad/s²] or [m/s²].
        load_torque: Torque that the joint transmits to its load [N·m] or [N].
        normal_load: In the unit of the law's reference load; None where the law is to take its reference.
        temperature: [°C].
    """

    __slots__ = ("acceleration", "load_torque", "normal_load", "position", "temperature")

    def __init__(self) -> None:
        self.position = 0.0
        self.acceleration = 0.0
        self.load_torque = 0.0
        self.normal_load: float | None = None
        self.temperature: float | None = None


class JointFriction:
    """The friction of one joint, in plain floats: a step of the default law costs about a microsecond.

    Attributes:
        pushes: Whether `applied` can be other than zero.
        inputs: What the law depends on besides velocity and normal load.

    Args:
        law: Any friction law.
    """

    def __init__(self, law: FrictionLaw) -> None:
        self.law = law
        self.offset = 0.0
        """Torque that acts whatever the direction of motion [N·m], at the last step."""
        self.bristle_torque = 0.0
        """Torque of the dynamic terms beside their level [N·m], at the last step."""
        self.inputs = find_inputs(law.terms)
        self._build, self.pushes = _compile(law)
        self._start()

    def reset(self) -> None:
        """Back to rest without load."""
        self._start()
        self.offset = self.bristle_torque = 0.0

    def _start(self) -> None:
        """States of the dynamic terms at rest."""
        self._applied, self._forward, self._reverse = self._build()

    def applied(self, velocity: float, contact: Contact, dt: float) -> float:
        """Torque [N·m] that acts whatever the direction of motion: offsets and bristles, advanced by `dt` [s].

        Needed before every `level` of a law that `pushes`.
        """
        self.offset, self.bristle_torque = self._applied(velocity, contact, dt)
        return self.offset + self.bristle_torque

    def level(self, velocity: float, free_velocity: float, mobility: float, contact: Contact) -> float:
        """Bound on the dry torque over the coming step [N·m].

        Args:
            velocity: At the start of the step [rad/s].
            free_velocity: At its end if there were no friction [rad/s]; its sign is the direction of motion or,
                at rest, of impending motion.
            mobility: Step over inertia, dt/J: change of velocity a unit of torque makes [rad/s/(N·m)].
            contact: The joint's state.
        """
        direction = 1.0 if free_velocity >= 0.0 else -1.0
        speed = velocity * direction
        speed = speed if speed > 0.0 else 0.0
        total, slope = self._forward(speed, contact) if direction > 0.0 else self._reverse(speed, contact)
        if slope > 0.0:
            after = (free_velocity * direction - mobility * (total - slope * speed)) / (1.0 + mobility * slope)
            total += slope * ((after if after > 0.0 else 0.0) - speed)
        return total if total > 0.0 else 0.0


def has_bristle(term: DynamicTerm) -> bool:
    """Whether the dry part of `term` is a bristle, and no level against which the joint holds still."""
    return trace_step(term, TracedPoint(), Symbol("dt")).parts.bristle is not None


_NAMES = {
    **{name: f"contact.{name}" for name in ("position", "acceleration", "load_torque", "normal_load", "temperature")},
    **{f"has_{name}": f"contact.{name} is not None" for name in ("normal_load", "temperature")},
    "is_forward": "velocity >= 0.0",
    "speed": "abs(velocity)",
}
"""Text of the symbols of a formula."""


def _compile(law: FrictionLaw) -> tuple[Any, bool]:
    """A function that gives `applied` and the levels of both directions, from rest; and whether any torque is applied.

    The former takes velocity, contact and step, and gives offset and bristle torque; the latter take speed and
    contact, and give the level and its slope over the speed [N·m·s/rad].
    """
    statics = [trace_parts(term) for term in law.terms if not isinstance(term, DynamicTerm)]
    steps = _trace_steps(law, TracedPoint())
    names = [name for step in steps for name in step.states]
    held = add_up([parts.held for parts in statics])
    beside = add_up([part for step in steps for part in (step.parts.held, step.parts.drag, step.parts.bristle)])
    pushes = bool(steps) or any(parts.held is not None for parts in statics)
    lines = [
        "def build():",
        *(f"    {name} = 0.0" for name in names),
        "    def applied(velocity, contact, dt):",
        *([f"        nonlocal {', '.join(names)}"] if names else []),
        *_indent(
            _assign(
                {f"{name}_after": after for step in steps for name, after in zip(step.states, step.after, strict=True)}
            )
        ),
        *_indent(_assign({"offset": held, "beside": beside})),
        *(f"        {name} = {name}_after" for name in names),
        "        return offset, beside",
        *_level_lines(law, "forward", 1.0),
        *_level_lines(law, "reverse", -1.0),
        "    return applied, forward, reverse",
    ]
    return compile_python(lines, "build"), pushes


def _trace_steps(law: FrictionLaw, point: TracedPoint) -> list[TracedStep]:
    return [trace_step(term, point, Symbol("dt")) for term in law.terms if isinstance(term, DynamicTerm)]


def _level_lines(law: FrictionLaw, name: str, sign: float) -> list[str]:
    """Lines of the level of one direction: what is dry, and what drags by no state."""
    speed: Any = Symbol("speed")
    point = TracedPoint(velocity=sign * speed, forward=sign > 0.0)
    parts: list[Parts] = [trace_parts(term, point) for term in law.terms if not isinstance(term, DynamicTerm)]
    steps = _trace_steps(law, point)
    dry = add_up([*(each.dry for each in parts), *(step.parts.dry for step in steps)])
    drag: Any = sign * add_up([each.drag for each in parts])
    slopes = {"slope": differentiate(drag, "speed"), "rise": differentiate(dry, "speed")}
    formulas: dict[str, Expression] = {"level": dry + drag}
    formulas |= {key: slope for key, slope in slopes.items() if slope is not None}
    states = {f"{state}_after": state for step in steps for state in step.states}
    body = ["probed = speed if speed > CREEP else CREEP", *_assign(formulas, states | {"speed": "probed"})]
    body += ["slope = 0.0"] if slopes["slope"] is None else []
    body += [] if slopes["rise"] is None else ["if rise > 0.0:", "    slope += rise"]  # a fall is met as it comes
    return [
        f"    def {name}(speed, contact, CREEP={CREEP!r}):",
        *_indent([*body, "return level + slope * (speed - probed), slope"]),
    ]


def _assign(formulas: dict[str, Expression], names: dict[str, str] | None = None) -> list[str]:
    lines, texts = print_python(list(formulas.values()), _NAMES | (names or {}))
    return [*lines, *(f"{name} = {text}" for name, text in zip(formulas, texts, strict=True))]


def _indent(lines: Sequence[str]) -> list[str]:
    return [f"        {line}" for line in lines]
