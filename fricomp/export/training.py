"""A model as settings of simulators that train policies, and of a robot's controllers.

What each calls its numbers, from their sources:

- Isaac Lab (`ActuatorBaseCfg`): `friction` is the effort that holds a joint at rest, `dynamic_friction` the level while
  it moves, `viscous_friction` the slope; PhysX takes all three as efforts since Isaac Sim 5.0.
- mjlab (`ActuatorCfg`): `frictionloss` and `viscous_damping` go into MuJoCo's joint; None keeps what the XML says.
- Newton (`ModelBuilder.JointDofConfig`): `friction` is one level, `damping` the slope.
- ROS 2: no standard parameter holds friction; the file is a parameter file for a node or controller of your own.
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence

from fricomp.export.levels import FrictionLevels


def render_training(levels: Sequence[FrictionLevels], to: str) -> str:
    """Settings of one joint or several as text that can be pasted or loaded.

    Args:
        levels: From `fit_friction_levels`, one a joint.
        to: One of `TRAINING_FORMATS`.

    Raises:
        KeyError: The format is unknown.
    """
    return TRAINING_FORMATS[to](levels)


def _render_isaaclab(levels: Sequence[FrictionLevels]) -> str:
    settings = {
        "friction": {each.joint: each.static for each in levels},
        "dynamic_friction": {each.joint: each.sliding for each in levels},
        "viscous_friction": {each.joint: each.viscous for each in levels},
    }
    note = "needs Isaac Sim 5.0 or newer: before, `friction` was a coefficient without unit"
    return _render_python("ImplicitActuatorCfg(**FRICTION, ...)", settings, levels, note)


def _render_mjlab(levels: Sequence[FrictionLevels]) -> str:
    groups = [
        {
            "target_names_expr": (re.escape(each.joint),),  # matches this joint alone
            "frictionloss": _round(each.sliding),
            "viscous_damping": _round(each.viscous),
        }
        for each in levels
    ]
    body = "".join(f"    {group!r},\n" for group in groups)
    use = "actuators=tuple(BuiltinPositionActuatorCfg(**each, stiffness=..., damping=...) for each in FRICTION)"
    return f"{_comment(levels, 'an actuator a joint')}# {use}\nFRICTION = (\n{body})\n"


def _render_newton(levels: Sequence[FrictionLevels]) -> str:
    settings = {each.joint: {"friction": each.sliding, "damping": each.viscous} for each in levels}
    use = "ModelBuilder.JointDofConfig(axis=..., **FRICTION[joint])"
    return _render_python(use, settings, levels, "one level: what holds at rest is the level of sliding")


def _render_ros2(levels: Sequence[FrictionLevels]) -> str:
    lines = ["friction_compensation:", "  ros__parameters:"]
    lines += [f"    joints: {json.dumps([each.joint for each in levels])}"]
    for each in levels:
        lines += [f"    {json.dumps(each.joint)}:"]
        numbers = {"static": each.static, "coulomb": each.sliding, "viscous": each.viscous}
        lines += [f"      {name}: {_round(value)!r}" for name, value in numbers.items()]
    return _comment(levels, "static and coulomb are levels, viscous is a slope") + "\n".join(lines) + "\n"


TRAINING_FORMATS: Mapping[str, Callable[[Sequence[FrictionLevels]], str]] = {
    "isaaclab": _render_isaaclab,
    "mjlab": _render_mjlab,
    "newton": _render_newton,
    "ros2": _render_ros2,
}


def _render_python(
    use: str, settings: Mapping[str, Mapping[str, float]], levels: Sequence[FrictionLevels], note: str
) -> str:
    body = "".join(
        f"    {outer!r}: {{{', '.join(f'{name!r}: {_round(value)!r}' for name, value in inner.items())}}},\n"
        for outer, inner in settings.items()
    )
    return f"{_comment(levels, note)}# {use}\nFRICTION = {{\n{body}}}\n"


def _comment(levels: Sequence[FrictionLevels], note: str) -> str:
    """What a reader has to know, as comments of Python and of YAML; no name of a joint can end a line."""
    lines = [f"# {note}"]
    for each in levels:
        unit, slope = ("N·m", "N·m·s/rad") if each.rotary else ("N", "N·s/m")
        lines.append(f"# {json.dumps(each.joint)} [{unit}], [{slope}]: {each.fidelity}")
    return "".join(f"{line}\n" for line in lines)


def _round(value: float) -> float:
    return float(f"{value:.9g}")
