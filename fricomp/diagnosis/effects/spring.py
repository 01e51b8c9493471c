"""What a named spring says: its centre only where it shows, and beside a simulation with a spring how far it is off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from msgspec.structs import replace as with_fields

from fricomp.laws import SpringTorque, Term

from ..inputs.rigid import Spring
from ..joint.observer import Plant
from ..record.result import Change, NamedEffect, Quantity

__all__ = ["SPRING", "SPRING_CHANGE", "combine_springs", "compare_spring", "describe_spring"]

_NO_CENTRE = "its centre is not determined, since that of a straight one is a constant torque"
SPRING, SPRING_CHANGE = "spring_torque", "spring_stiffness"


def describe_spring(effect: NamedEffect, given: Spring | None) -> NamedEffect:
    """A spring as the recording shows it; other effects stay as they are.

    The centre of a straight one is an offset, which the base has as well: no recording tells the two apart, and an
    interval of it would be one of the steps by which the fit's derivatives are taken. A spring beside the
    simulation's own is a parameter of that one.

    Args:
        effect: As it was named: the stiffness is the difference.
        given: Of the simulation; None where it has no spring.
    """
    if effect.name != SPRING:
        return effect
    if effect.parameters["hardening"].ci95[0] > 0.0:  # the simulation has no term by which its own would stiffen so
        beside = "" if given is None else ", beside that of the simulation"
        return with_fields(effect, sentence=effect.sentence + beside)
    rest = {name: one for name, one in effect.parameters.items() if name != "centre"}
    if given is None:
        return with_fields(effect, parameters=rest, sentence=f"{effect.sentence}; {_NO_CENTRE}")
    change = rest.pop("stiffness")
    whole = _add_given(change, given)
    unit = change.unit
    if whole.ci95[0] <= 0.0:
        sentence = f"the simulation has a spring of {given.stiffness:.4g} {unit} that the joint does not show"
    else:
        sentence = f"the joint's spring has {whole.value:.4g} {unit}, that of the simulation {given.stiffness:.4g}"
    parameters = {"stiffness_change": change, **rest}
    return with_fields(effect, kind="parameter", parameters=parameters, sentence=sentence, equation="")


def compare_spring(effects: Sequence[NamedEffect], given: Spring | None) -> tuple[Change, ...]:
    """The stiffness of the simulation and of the joint, where the two were found to differ."""
    if given is None:
        return ()
    changes = (one.parameters.get("stiffness_change") for one in effects if one.name == SPRING)
    return tuple(
        Change(name=SPRING_CHANGE, given=given.stiffness, refitted=_add_given(one, given)) for one in changes if one
    )


def combine_springs(found: Mapping[str, float], plant: Plant, given: Spring) -> tuple[Term | None, Plant]:
    """The joint's whole spring from what was found beside the simulation's, and the plant with the constant that it
    leaves: a law that is written into the simulation stands in place of the spring there.

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


def _add_given(change: Quantity, given: Spring) -> Quantity:
    low, high = change.ci95
    return Quantity(given.stiffness + change.value, change.unit, (given.stiffness + low, given.stiffness + high))
