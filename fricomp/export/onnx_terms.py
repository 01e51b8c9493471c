"""Terms over load, position, temperature and acceleration as nodes of an ONNX graph, one set for all joints.

A joint that lacks a term has it with parameters under which it is nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fricomp.control.extra_terms import TermKind
from fricomp.errors import ExportError
from fricomp.laws import (
    Cogging,
    EndStop,
    FloatArray,
    KinematicError,
    LoadCoulomb,
    LoadQuadratic,
    LoadStribeck,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SpringTorque,
    Term,
    ThermalFriction,
    ThermalViscous,
)
from fricomp.laws.thermal_friction import STRONGEST_FALL

__all__ = ["OnnxTerm", "extra_constants", "extra_nodes"]

Steps = Sequence[tuple[str, Sequence[str], str]]
"""Operator, inputs and output of each node; parameters and intermediates carry the term's name in front."""


@dataclass(frozen=True)
class OnnxTerm:
    """A term as operators.

    Attributes:
        kind: `dry` terms are levels, multiplied by the sign of the velocity; the others are signed themselves.
        neutral: Its parameters, with values under which it is nothing.
        steps: Over `velocity`, `speed`, `sign`, `is_forward`, `position`, `load_torque`, `temperature`, `acceleration`,
            `one`, the parameters and the fixed numbers; ends in `torque`.
        fixed: Numbers that are the same for every joint.
        has_level: Whether there is a `level` among the steps, a dry part beside `torque`.
    """

    kind: TermKind
    neutral: Mapping[str, float]
    steps: Steps
    fixed: Mapping[str, float] = field(default_factory=dict)
    has_level: bool = False


_WAVE: Steps = (
    ("Mul", ("position", "order_"), "angle_"),
    ("Sin", ("angle_",), "sin_"),
    ("Cos", ("angle_",), "cos_"),
    ("Mul", ("sin_", "sine_"), "first_"),
    ("Mul", ("cos_", "cosine_"), "second_"),
    ("Add", ("first_", "second_"), "torque_"),
)
_WAVE_PARAMETERS = {"sine": 0.0, "cosine": 0.0, "order": 1.0}

_TERMS: dict[type[Term], OnnxTerm] = {
    Cogging: OnnxTerm("held", _WAVE_PARAMETERS, _WAVE),
    PositionCoulomb: OnnxTerm("dry", _WAVE_PARAMETERS, _WAVE),
    SpringTorque: OnnxTerm(
        "held",
        {"stiffness": 0.0, "centre": 0.0, "hardening": 0.0},
        (
            ("Sub", ("position", "centre_"), "stretch_"),
            ("Mul", ("stretch_", "stiffness_"), "straight_"),
            ("Mul", ("stretch_", "stretch_"), "square_"),
            ("Mul", ("square_", "hardening_"), "share_"),
            ("Mul", ("straight_", "share_"), "stiffer_"),
            ("Add", ("straight_", "stiffer_"), "torque_"),
        ),
    ),
    EndStop: OnnxTerm(
        "held",
        {"stiffness": 0.0, "edge": 0.0, "side": 1.0},
        (
            ("Sub", ("position", "edge_"), "past_"),
            ("Mul", ("past_", "side_"), "into_"),
            ("Relu", ("into_",), "depth_"),
            ("Mul", ("depth_", "stiffness_"), "size_"),
            ("Mul", ("size_", "side_"), "torque_"),
        ),
    ),
    LoadCoulomb: OnnxTerm(
        "dry",
        {"coefficient": 0.0},
        (("Abs", ("load_torque",), "load_"), ("Mul", ("load_", "coefficient_"), "torque_")),
    ),
    LoadQuadratic: OnnxTerm(
        "dry",
        {"coefficient": 0.0},
        (("Mul", ("load_torque", "load_torque"), "square_"), ("Mul", ("square_", "coefficient_"), "torque_")),
    ),
    LoadStribeck: OnnxTerm(
        "dry",
        {"coefficient": 0.0, "stribeck_velocity": 1.0},
        (
            ("Div", ("speed", "stribeck_velocity_"), "ratio_"),
            ("Mul", ("ratio_", "ratio_"), "square_"),
            ("Neg", ("square_",), "minus_"),
            ("Exp", ("minus_",), "falling_"),
            ("Abs", ("load_torque",), "load_"),
            ("Mul", ("load_", "falling_"), "share_"),
            ("Mul", ("share_", "coefficient_"), "torque_"),
        ),
    ),
    QuadraticDrag: OnnxTerm(
        "drag",
        {"coefficient": 0.0},
        (("Mul", ("velocity", "speed"), "square_"), ("Mul", ("square_", "coefficient_"), "torque_")),
    ),
    PowerLawViscous: OnnxTerm(
        "drag",
        {"coefficient": 0.0, "exponent": 1.0},
        (
            ("Pow", ("speed", "exponent_"), "power_"),
            ("Mul", ("power_", "coefficient_"), "size_"),
            ("Mul", ("size_", "sign"), "torque_"),
        ),
    ),
    ThermalViscous: OnnxTerm(
        "drag",
        {"slope": 0.0, "reference_temperature": 0.0},
        (
            ("Sub", ("reference_temperature_", "temperature"), "coolness_"),
            ("Mul", ("coolness_", "slope_"), "coefficient_"),
            ("Mul", ("coefficient_", "velocity"), "torque_"),
        ),
    ),
    ThermalFriction: OnnxTerm(
        "drag",
        {
            "forward_viscous": 1.0,
            "reverse_viscous": 1.0,
            "viscous_slope": 0.0,
            "coulomb_slope": 0.0,
            "reference_temperature": 0.0,
        },
        (
            ("Sub", ("temperature", "reference_temperature_"), "warmth_"),
            ("Where", ("is_forward", "forward_viscous_", "reverse_viscous_"), "viscous_"),
            ("Mul", ("warmth_", "viscous_slope_"), "loss_"),
            ("Div", ("loss_", "viscous_"), "fall_"),
            ("Min", ("fall_", "strongest_"), "below_"),
            ("Max", ("below_", "weakest_"), "bounded_"),
            ("Neg", ("bounded_",), "minus_"),
            ("Exp", ("minus_",), "share_"),
            ("Sub", ("share_", "one"), "change_"),
            ("Mul", ("change_", "viscous_"), "coefficient_"),
            ("Mul", ("coefficient_", "velocity"), "torque_"),
            ("Mul", ("warmth_", "coulomb_slope_"), "lost_"),
            ("Neg", ("lost_",), "level_"),
        ),
        {"strongest": STRONGEST_FALL, "weakest": -STRONGEST_FALL},
        has_level=True,
    ),
    KinematicError: OnnxTerm(
        "held",
        {
            "sine": 0.0,
            "cosine": 0.0,
            "order": 1.0,
            "load_inertia": 0.0,
            "gravity_cosine": 0.0,
            "gravity_sine": 0.0,
        },
        (
            ("Mul", ("position", "order_"), "angle_"),
            ("Sin", ("angle_",), "sin_"),
            ("Cos", ("angle_",), "cos_"),
            ("Mul", ("sin_", "sine_"), "first_"),
            ("Mul", ("cos_", "cosine_"), "second_"),
            ("Add", ("first_", "second_"), "error_"),
            ("Mul", ("cos_", "sine_"), "third_"),
            ("Mul", ("sin_", "cosine_"), "fourth_"),
            ("Sub", ("third_", "fourth_"), "turned_"),
            ("Mul", ("turned_", "order_"), "slope_"),
            ("Sin", ("position",), "across_"),
            ("Cos", ("position",), "along_"),
            ("Mul", ("along_", "gravity_cosine_"), "fifth_"),
            ("Mul", ("across_", "gravity_sine_"), "sixth_"),
            ("Add", ("fifth_", "sixth_"), "gravity_"),
            ("Mul", ("along_", "gravity_sine_"), "seventh_"),
            ("Mul", ("across_", "gravity_cosine_"), "eighth_"),
            ("Sub", ("seventh_", "eighth_"), "gradient_"),
            ("Mul", ("acceleration", "load_inertia_"), "inertial_"),
            ("Add", ("inertial_", "inertial_"), "twice_"),
            ("Add", ("gravity_", "twice_"), "acting_"),
            ("Mul", ("slope_", "acting_"), "pushed_"),
            ("Mul", ("order_", "velocity"), "passing_"),
            ("Mul", ("passing_", "passing_"), "square_"),
            ("Mul", ("square_", "load_inertia_"), "centrifugal_"),
            ("Sub", ("gradient_", "centrifugal_"), "bent_"),
            ("Mul", ("bent_", "error_"), "held_"),
            ("Add", ("pushed_", "held_"), "torque_"),
        ),
    ),
}


def extra_constants(laws: Sequence[Sequence[Term]]) -> dict[str, FloatArray]:
    """Parameters of the extra terms of each joint, each of shape (n_joints, 1).

    Raises:
        ExportError: A term cannot be written as operators.
    """
    constants: dict[str, FloatArray] = {}
    for kind in _kinds(laws):
        owned = [next((term for term in terms if type(term) is kind), None) for terms in laws]
        for name, neutral in _TERMS[kind].neutral.items():
            values = [neutral if term is None else term.parameters()[name] for term in owned]
            constants[f"{kind.name}_{name}_"] = np.array(values)[:, None]
        for name, value in _TERMS[kind].fixed.items():
            constants[f"{kind.name}_{name}_"] = np.array([[value]])
    return constants


def extra_nodes(node: Callable[..., Any], laws: Sequence[Sequence[Term]]) -> list[Any]:
    """Nodes that turn `plain_torque` into `torque`, with the terms of all joints added.

    All levels together take at most the `dry_level` of the curve, so that dry friction never drives.
    """
    nodes: list[Any] = []
    added = ["plain_torque"]
    levels: list[str] = []
    for kind in _kinds(laws):
        term = _TERMS[kind]

        def own(text: str, name: str = kind.name) -> str:
            return f"{name}_{text}" if text.endswith("_") else text

        nodes += [node(operator, [own(i) for i in inputs], [own(output)]) for operator, inputs, output in term.steps]
        (levels if term.kind == "dry" else added).append(own("torque_"))
        if term.has_level:
            levels.append(own("level_"))
    if levels:
        nodes += [
            node("Sum", levels, ["level_beside"]),
            node("Neg", ["dry_level"], ["least_beside"]),
            node("Max", ["level_beside", "least_beside"], ["held_beside"]),
            node("Mul", ["held_beside", "sign"], ["dry_beside"]),
        ]
        added.append("dry_beside")
    return [*nodes, node("Sum", added, ["torque"])] if len(added) > 1 else nodes


def _kinds(laws: Sequence[Sequence[Term]]) -> list[type[Term]]:
    """Classes of the terms of all laws, in the order of the table.

    Raises:
        ExportError: A term cannot be written as operators.
    """
    found = {type(term) for terms in laws for term in terms}
    unknown = sorted(kind.name for kind in found if kind not in _TERMS)
    if unknown:
        raise ExportError(
            f"the terms {', '.join(unknown)} have no closed form in ONNX: a graph holds one dry curve (Coulomb, "
            "Stribeck, Dahl or LuGre), viscous friction and drag, and terms over load, position, temperature and "
            "acceleration"
        )
    return [kind for kind in _TERMS if kind in found]
