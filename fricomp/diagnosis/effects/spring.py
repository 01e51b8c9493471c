"""The joint's whole spring, from what was found beside that of the simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from fricomp.laws import SpringTorque, Term

from ..inputs.rigid import Spring
from ..joint.observer import Plant

SPRING, SPRING_CHANGE = "spring_torque", "spring_stiffness"


def combine_springs(found: Mapping[str, float], plant: Plant, given: Spring) -> tuple[Term | None, Plant]:
    """Combine the simulation's spring with what was found beside it, and put the constant torque that is left into the
    plant. A law that is written into the simulation stands in place of the spring there.

    Args:
        found: Parameters of the effect.
        plant: The joint beside it.
        given: Spring of the simulation.

    Returns:
        No term where no spring of the laws has such a form.
    """
    square, cube = (*given.coefficients[1:], 0.0, 0.0)[:2]
    change, centre, hardening = (found[name] for name in ("stiffness", "centre", "hardening"))
    stiffness = max(given.stiffness + change, 0.0)
    if square or (cube and hardening) or any(given.coefficients[3:]):
        return None, plant
    if hardening > 0.0 and change > 0.0:  # about its own centre, where the given spring has some torque
        constant, cube = given.stiffness * (centre - given.reference), change * hardening
    else:  # the centre of a straight spring lies in the offset
        constant, centre = change * (given.reference - centre), given.reference
    hardening = max(cube, 0.0) / stiffness if stiffness else 0.0
    return SpringTorque(stiffness, centre, hardening), replace(plant, offset=plant.offset + constant)
