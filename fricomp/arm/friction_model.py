"""Friction of one joint of an arm as a model file like any other."""

from __future__ import annotations

import numpy as np

from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    FrictionLaw,
    LoadCoulomb,
    LoadQuadratic,
    LuGre,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SmoothedCoulomb,
    SpringTorque,
    StribeckCurve,
    Term,
    ThermalFriction,
)
from fricomp.model import FrictionModel, Provenance, Validity
from fricomp.recording.metadata import list_dates

from .arm_recording import find_start_temperature
from .columns import CREEP_ROUNDING
from .comparison.torque_scale import scale_values
from .friction import BRISTLE, CREEP, STRIBECK_EXPONENTS, TERMS
from .identification import ArmIdentification
from .law_fit import fit_within_law

_LEAST_PART = 1e-3
"""Of the mean Coulomb level, below which a level of one direction is not taken: a law has positive levels only."""

_SHIFTS = (-0.4, 0.6)
"""How far a Stribeck velocity, or an exponent, may lie from that of the columns, as part of it."""

_LEAST_VISCOUS = 1e-6
"""[N·m·s/rad] of a joint that has none: its change with the temperature needs a positive one."""


_MOST_PART = 0.95
"""Of the Coulomb level, from which all of it is taken to bend: what is left could not be told from none."""


def build_friction_model(found: ArmIdentification, joint: int) -> FrictionModel:
    """The friction law of a joint, with the range of the motion in which it was seen.

    Args:
        found: The identified arm.
        joint: Number of the joint.
    """
    values, form = fit_within_law(found, joint), dict(found.fit.model.forms[joint].terms)
    values = scale_values(found.fit, joint, values)
    terms = [*_build_core(found, joint, values, form), *_build_terms(found, joint, values, form)]
    metadata, motion = found.recording.metadata[joint], found.rows.motion
    load = found.fit.compute_load(found.rows)[:, joint]
    return FrictionModel(
        law=FrictionLaw(tuple(terms)),
        joint=metadata.joint,
        motion=metadata.motion,
        torque_unit=metadata.torque_unit,
        validity=Validity(
            velocity=_range(np.concatenate([v[:, joint] for _, v, _ in motion])),
            position=_range(np.concatenate([q[:, joint] for q, _, _ in motion])),
            load_torque=_range(load),
        ),
        provenance=Provenance(
            method="arm",
            data_sha256=found.recording.recordings[joint].content_hash,
            notes=list_dates(found.recording.metadata),
        ),
    )


def _build_core(
    found: ArmIdentification, joint: int, values: dict[str, float], form: dict[str, int]
) -> tuple[Term, ...]:
    """The curves of both directions, and the parts of their level that creep, or that a bristle builds up."""
    if CREEP in form:
        level = values[TERMS[CREEP].names(form[CREEP])[0]]
        others = {name: one for name, one in form.items() if name != CREEP}
        soft = SmoothedCoulomb(max(level, 0.0), CREEP_ROUNDING * find_creep_velocity(found, joint))
        return (*_build_core(found, joint, values | {"coulomb": values["coulomb"] - level}, others), soft)
    level = values[TERMS[BRISTLE].names(form[BRISTLE])[0]] if BRISTLE in form else 0.0
    if level <= _LEAST_PART * values["coulomb"]:  # none, or less than a law can have beside the rest
        return (BidirectionalStribeck(*_build_curves(found, joint, values, form)),)
    distance = _value_of(found, joint, BRISTLE, form)
    if level > _MOST_PART * values["coulomb"]:
        curves = _build_curves(found, joint, values, form)
        return (LuGre(*curves, curves[0].coulomb_torque / distance, 0.0),)
    rest = _build_curves(found, joint, values | {"coulomb": values["coulomb"] - level}, form)
    bent = StribeckCurve(level, level, 1.0, 0.0)
    return (BidirectionalStribeck(*rest), LuGre(bent, bent, level / distance, 0.0))


def find_creep_velocity(found: ArmIdentification, joint: int) -> float:
    """Speed below which the friction of a joint that creeps is viscous [rad/s] or [m/s]."""
    values, form = found.fit.friction(joint), dict(found.fit.model.forms[joint].terms)
    level, width = (values[name] for name in TERMS[CREEP].names(form[CREEP]))
    shift = float(np.clip(width / level, *_SHIFTS)) if level > 0.0 else 0.0
    return float(found.equations.creep[joint, form[CREEP]]) * (1.0 + shift)


def _build_curves(
    found: ArmIdentification, joint: int, values: dict[str, float], form: dict[str, int]
) -> tuple[StribeckCurve, StribeckCurve]:
    """Forward and reverse curve, the constant torque in them as far as their levels stay positive."""
    level = max(values["coulomb"], 1e-9)
    offset = float(np.clip(values["offset"], -(1.0 - _LEAST_PART) * level, (1.0 - _LEAST_PART) * level))
    speed, excess, difference, exponent = 1.0, 0.0, 0.0, 2.0
    if "stribeck" in form:
        names = TERMS["stribeck"].names(form["stribeck"])
        excess, difference, *moves = (values[name] for name in names)
        shifts = np.clip(np.array(moves) / excess, *_SHIFTS) if excess > 0.0 else np.zeros(2)
        speed, exponent = (found.equations.stribeck[joint, form["stribeck"]] * (1.0 + shifts)).tolist()
        exponent = float(np.clip(exponent, *STRIBECK_EXPONENTS))
    curves = []
    for sign in (1.0, -1.0):
        coulomb = level + sign * offset
        static = max(coulomb + excess + sign * difference, _LEAST_PART * level)
        viscous = max(values["viscous"] + sign * values["viscous_difference"], 0.0)
        curves.append(StribeckCurve(coulomb, static, speed, viscous, exponent))
    return curves[0], curves[1]


def _build_terms(found: ArmIdentification, joint: int, values: dict[str, float], form: dict[str, int]) -> list[Term]:
    def parameters(name: str) -> list[float]:
        return [values[column] for column in TERMS[name].names(form[name])]

    terms: list[Term] = []
    if "load_coulomb" in form:
        terms.append(LoadCoulomb(max(parameters("load_coulomb")[0], 0.0)))
    if "load_quadratic" in form:
        terms.append(LoadQuadratic(max(parameters("load_quadratic")[0], 0.0)))
    if "position_coulomb" in form:
        cosine, sine = parameters("position_coulomb")
        terms.append(PositionCoulomb(sine, cosine, _value_of(found, joint, "position_coulomb", form)))
    if "quadratic_drag" in form:
        terms.append(QuadraticDrag(max(parameters("quadratic_drag")[0], 0.0)))
    if "power_law_viscous" in form:
        exponent, top = _value_of(found, joint, "power_law_viscous", form), float(found.equations.top_speed[joint])
        terms.append(PowerLawViscous(max(parameters("power_law_viscous")[0], 0.0) / top**exponent, exponent))
    if "cogging" in form:
        cosine, sine = parameters("cogging")
        terms.append(Cogging(sine, cosine, float(found.equations.ripple[joint])))
    if "thermal_friction" in form:
        level, slope = parameters("thermal_friction")
        viscous = max(values["viscous"], _LEAST_VISCOUS)
        start = find_start_temperature(found.recording.recordings[joint])
        terms.append(ThermalFriction(viscous, viscous, -slope, -level, start))
    if "spring_torque" in form:
        middle = float(np.mean(np.concatenate([q[:, joint] for q, _, _ in found.rows.motion])))
        terms.append(SpringTorque(max(parameters("spring_torque")[0], 0.0), middle))
    return terms


def _value_of(found: ArmIdentification, joint: int, name: str, form: dict[str, int]) -> float:
    return TERMS[name].list_values(rotary=found.fit.arm.rotary[joint])[form[name]]


def _range(values: np.ndarray) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))
