"""The largest torque that a compensation may give: the model's largest friction over its range of validity."""

import math

from fricomp.control.compensation.curve import FrictionCurves, split_law
from fricomp.control.compensation.trust import compute_torque_cap
from fricomp.laws import Ranges, ThermalFriction, ThermalViscous, find_inputs
from fricomp.model import FrictionModel

# Friction from a load of unknown range is trusted up to as much as all other friction together [1].
_UNKNOWN_LOAD_SHARE = 1.0
# What follows an acceleration of unknown range, up to as much as all else that its term may ask for [1].
_UNKNOWN_ACCELERATION_SHARE = 1.0


# A joint that has rested for long, or is cold or loaded, holds by more than a sweep has seen [1].
_BREAKAWAY_MARGIN = 1.5
_AT_REST = (0.0, 0.0)  # where nothing viscous counts [rad/s] or [m/s]


def compute_breakaway(model: FrictionModel) -> float | None:
    """Breakaway limit for the gate of a joint with this friction, in the unit of its model; None without any at rest.

    The largest friction at rest over the model's range of validity, with a margin for what no sweep has seen.
    """
    most, _ = compute_authority(model, split_law(model.law), _AT_REST)
    return _BREAKAWAY_MARGIN * most if most > 0.0 else None


def compute_authority(
    model: FrictionModel, curves: FrictionCurves, velocity_range: tuple[float, float]
) -> tuple[float, list[str]]:
    """Largest friction of `model` over its validity, in its torque unit, and what is unknown about it.

    That of the curves counts up to `compute_torque_cap`.

    Returns:
        The torque, and notes in sentences.
    """
    factors = [float(curves.load.factor(edge)) for edge in model.validity.normal_load or ()]
    cap = compute_torque_cap(model)
    largest = min(curves.largest(velocity_range, max([*factors, 1.0])), math.inf if cap is None else cap)
    over_load = [term for term in curves.extra if "load_torque" in find_inputs([term])]
    changes, warmth = find_acceleration_range(model, curves, velocity_range), find_temperature_range(model, curves)
    ranges = Ranges(velocity_range, model.validity.position, changes, model.validity.load_torque, warmth)
    largest += sum(term.largest_torque(ranges) for term in curves.extra if term not in over_load)
    notes = []
    if warmth is not None and model.validity.temperature is None:
        notes.append(
            f"the model states no range of temperature: it is followed from {warmth[0]:.4g} to {warmth[1]:.4g} °C, "
            "where a part of its friction doubles, or is halved or gone; give temperature_range and authority for more"
        )
    if changes is not None and model.validity.acceleration is None:
        notes.append(
            f"the model states no range of acceleration: it is followed up to {changes[1]:.3g}, where it brings "
            "as much as the rest of its term; give acceleration_range and authority for more"
        )
    if not over_load:
        return largest, notes
    if model.validity.load_torque is not None:
        return largest + sum(term.largest_torque(ranges) for term in over_load), notes
    notes.append(
        "the model states no range of load torque: friction from the load is compensated up to as much as all other "
        "friction together; give authority for more"
    )
    return largest * (1.0 + _UNKNOWN_LOAD_SHARE), notes


def find_acceleration_range(
    model: FrictionModel, curves: FrictionCurves, velocity_range: tuple[float, float]
) -> tuple[float, float] | None:
    """Accelerations that terms over them are told [rad/s²] or [m/s²]; None where no term follows them.

    Those of the model, or of either sign up to where a term would ask for as much again as without any.
    """
    ranges, edges = Ranges(velocity_range, model.validity.position, None, model.validity.load_torque), []
    for term in curves.extra:
        held = term.largest_torque(ranges)
        per_unit = term.largest_torque(ranges._replace(acceleration=(-1.0, 1.0))) - held
        if per_unit > 0.0:
            edges.append(_UNKNOWN_ACCELERATION_SHARE * held / per_unit)
    if not edges:
        return None
    return model.validity.acceleration or (-min(edges), min(edges))


def find_temperature_range(model: FrictionModel, curves: FrictionCurves) -> tuple[float, float] | None:
    """Temperatures that terms over them are told [°C]; None where nothing bounds them.

    Those of the model. Without them as far to either side of the reference as a part of the friction doubles on one.
    Viscous friction that falls in proportion would turn its sign and drive the joint: it is followed to where it
    vanishes, whatever the model states.
    """
    stated = model.validity.temperature
    low, high = stated or (-math.inf, math.inf)
    for term in curves.extra:
        if not isinstance(term, ThermalViscous | ThermalFriction):
            continue
        reach, reference = _compute_thermal_reach(term, curves), term.reference_temperature
        if stated is None:
            low, high = max(low, reference - reach), min(high, reference + reach)
        elif isinstance(term, ThermalViscous) and term.slope > 0.0:
            high = max(min(high, reference + reach), low)
        elif isinstance(term, ThermalViscous) and term.slope < 0.0:
            low = min(max(low, reference - reach), high)
    return None if math.isinf(high - low) and stated is None else (low, max(low, high))


def _compute_thermal_reach(term: ThermalViscous | ThermalFriction, curves: FrictionCurves) -> float:
    """Change of temperature at which a part of the friction has doubled, one way or the other [K]."""
    if isinstance(term, ThermalViscous):
        parts = [(min(curves.forward.viscous, curves.reverse.viscous), term.slope)]
    else:
        parts = [
            (math.log(2.0) * min(term.forward_viscous, term.reverse_viscous), term.viscous_slope),
            (min(curves.forward.coulomb, curves.reverse.coulomb), term.coulomb_slope),
        ]
    return min((size / abs(slope) for size, slope in parts if slope != 0.0), default=math.inf)
