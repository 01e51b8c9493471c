"""What a simulation states of friction and rotors beside what was found, in words; from the record alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fricomp.diagnosis.record.result import Quantity

from ..record import JointRecord
from .quantity import show_quantity

_OFF = 0.1
"""Part of what is stated by which a number must differ to be told: as much as an effect must matter."""

_WORDS = {"coulomb": "Coulomb friction", "viscous": "viscous friction", "rotor_inertia": "rotor"}
"""What the numbers are called, by their names in a record."""

_SHARED = ("load_", "power_law_viscous", "quadratic_drag", "thermal_friction")
"""Beginnings of terms that take a part of plain friction, so that its numbers are not those of a file without them."""


def say_stated(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """One sentence on the numbers that surely differ from what the simulation states of them, if any do."""
    lines = [
        f"{joint.name} {_WORDS[name]} {show_quantity(found)} for {joint.stated[name]:.3g}"
        for joint in joints
        for name, found in _list_off(joint)
    ]
    return (f"The simulation states other numbers: {'; '.join(lines)}.",) if lines else ()


def list_off_stated(joints: Sequence[JointRecord]) -> list[str]:
    """Joints of which the simulation surely states other friction, or another rotor."""
    return [joint.name for joint in joints if any(_list_off(joint))]


def _list_off(joint: JointRecord) -> Iterator[tuple[str, Quantity]]:
    shared = any(name.startswith(_SHARED) for name in (*joint.friction, *(one.name for one in joint.effects)))
    for name, stated in joint.stated.items():
        found = joint.rotor_inertia if name == "rotor_inertia" else joint.friction.get(name)
        if found is None or (shared and name != "rotor_inertia"):
            continue
        low, high = found.ci95
        if abs(found.value - stated) > _OFF * stated and not low <= stated <= high:
            yield name, found
