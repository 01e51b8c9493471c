"""What a simulation states of friction and rotors, beside what was found: wrong numbers of physics that it has."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fricomp.diagnosis.record.result import Quantity

from ..record import JointRecord
from ..rigid.simulated_arm import SimulatedArm

_OFF = 0.1
"""Part of what is stated by which a number must differ to be told: as much as an effect must matter."""

_WORDS = {"coulomb": "Coulomb friction", "viscous": "viscous friction", "rotor_inertia": "rotor"}
"""What the numbers are called, by their names in a record."""

_SHARED = ("load_", "power_law_viscous", "quadratic_drag", "thermal_friction")
"""Beginnings of terms that take a part of plain friction, so that its numbers are not those of a file without them."""


def list_stated(arm: SimulatedArm, joint: int) -> dict[str, float]:
    """Numbers of a joint that the file states, in the units of a record: those that are not zero.

    Args:
        arm: The simulation.
        joint: Number of the joint.
    """
    coulomb, viscous = arm.friction[joint].tolist()
    stated = {"coulomb": coulomb, "viscous": viscous, "rotor_inertia": float(arm.armature[joint])}
    return {name: value for name, value in stated.items() if value > 0.0}


def say_stated(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """One sentence on the numbers that surely differ from what the simulation states of them, if any do."""
    lines = [
        f"{joint.name} {_WORDS[name]} {found.value:.3g} {found.unit} ({found.ci95[0]:.3g} to {found.ci95[1]:.3g}) for "
        f"{joint.stated[name]:.3g}"
        for joint in joints
        for name, found in _list_off(joint)
    ]
    return (f"The simulation states other numbers: {'; '.join(lines)}.",) if lines else ()


def _list_off(joint: JointRecord) -> Iterator[tuple[str, Quantity]]:
    shared = any(name.startswith(_SHARED) for name in (*joint.friction, *(one.name for one in joint.effects)))
    for name, stated in joint.stated.items():
        found = joint.rotor_inertia if name == "rotor_inertia" else joint.friction.get(name)
        if found is None or (shared and name != "rotor_inertia"):
            continue
        low, high = found.ci95
        if abs(found.value - stated) > _OFF * stated and not low <= stated <= high:
            yield name, found
