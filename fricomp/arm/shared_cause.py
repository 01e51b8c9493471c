"""Causes that joints share: what shows in most joints at once is likelier one cause than as many of their own."""

from __future__ import annotations

from collections.abc import Sequence

from .record import JointRecord

__all__ = ["say_shared_causes"]

_LEAST, _SHARE = 3, 0.5
"""Joints, and part of all joints, in which an effect must show to be told as shared."""

_CAUSES = {
    "load_coulomb": "the same kind of gear in all of them, or torques of the joints in wrong units",
    "load_quadratic": "the same kind of gear in all of them, or torques of the joints in wrong units",
    "presliding_hysteresis": "the same kind of gear or bearing in all of them, or a clock that is coarse at reversals",
    "thermal_friction": "the arm that warms up as a whole: let it run warm, or record both states",
    "torque_delay": "the bus or the drives' firmware: look at how late the torques are stamped",
    "torque_gain_error": "the supply, or torque constants of one kind: compare them with the drives' data sheets",
}
"""What effects have in common where several joints show them."""


def say_shared_causes(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """One sentence on each effect that half of the joints show, with their names and what they may share."""
    lines = []
    for name in sorted({effect.name for joint in joints for effect in joint.effects}):
        shown = [joint.name for joint in joints if any(effect.name == name for effect in joint.effects)]
        if len(shown) >= max(_LEAST, _SHARE * len(joints)):
            cause = _CAUSES.get(name, "one cause")
            lines.append(
                f"{name} shows in {len(shown)} of {len(joints)} joints ({', '.join(shown)}). What they share "
                f"comes first: {cause}."
            )
    return tuple(lines)
