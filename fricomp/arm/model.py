"""What is fitted to an arm beside its links, rotors and plain friction."""

from __future__ import annotations

from dataclasses import dataclass

from .friction import JointForm

__all__ = ["ArmModel"]


@dataclass(frozen=True)
class ArmModel:
    """What is fitted beside links within the prior, rotors, and plain friction.

    Attributes:
        forms: Friction of each joint.
        opened: Links that may be far off.
        tilted: Whether gravity may lean over, as it does where the base of the arm is not level.
        gain: Whether all torques may have a common gain.
        rotorless: Joints without a rotor's inertia: their torques, such as those of a sensor behind the gear, asked for
            less than none.
        pinned: Numbers of joints and names of friction parameters that are held at zero, since a joint would feed
            energy in with what the recording asks for.
    """

    forms: tuple[JointForm, ...]
    opened: frozenset[int] = frozenset()
    tilted: bool = False
    gain: bool = False
    rotorless: frozenset[int] = frozenset()
    pinned: frozenset[tuple[int, str]] = frozenset()
