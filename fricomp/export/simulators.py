"""A model in the words of a simulator: MJCF for MuJoCo, URDF for everything else; each with what it loses."""

import math
import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.compensation.trust import bound_friction, require_usable, trusted_curves
from fricomp.errors import ExportError
from fricomp.export.default_class import joint_type
from fricomp.export.fidelity import Fidelity, compute_fidelity, fit_levels, sample_friction
from fricomp.export.levels import drop_terms, find_held_terms, fit_friction_levels, join_levels, require_torque
from fricomp.laws import Cogging, FloatArray, SpringTorque
from fricomp.model import FrictionModel

MjcfWay = Literal["dcmotor", "damping", "frictionloss"]
MJCF_WAYS: tuple[MjcfWay, ...] = ("dcmotor", "damping", "frictionloss")

# MuJoCo's default friction constraint creeps at 90 % of breakaway; these two together make it stick.
_STICKING = {"solreffriction": "0.002 1", "solimpfriction": "0.9999 0.9999 0.001 0.5 2"}
_SPRING_NOTE = " stiffness and springref by fricomp "  # inside the joint, for the next export
_BREAKAWAY_TRAVEL = 1e-4  # [rad] or [m], a stiff joint's; where the model has no bristle
_BRISTLE_TIME = 1e-3  # sigma_1/sigma_0 [s], likewise


@dataclass(frozen=True)
class SimulatorExport:
    """Friction of one joint for a simulator.

    Attributes:
        joint: Attributes of the joint's element (MJCF `joint`, URDF `dynamics`).
        actuator: Attributes of an extra MJCF `dcmotor`, or empty.
        fidelity: What is lost.
    """

    joint: Mapping[str, str]
    fidelity: Fidelity
    actuator: Mapping[str, str] = field(default_factory=dict)


def export_mjcf(model: FrictionModel, way: MjcfWay = "dcmotor", *, any_status: bool = False) -> SimulatorExport:
    """Friction for MuJoCo 4.

    Args:
        model: What is exported.
        way: `dcmotor`: a passive motor with LuGre friction, and joint damping. `damping`: the joint's damping
            polynomial alone. `frictionloss`: a level that truly sticks, and damping.
        any_status: Take a model too that its identification calls unusable.

    Raises:
        ExportError: The way is unknown, or the model is not in newton metres or newtons.
        ParameterError: The model is not usable.
    """
    if way not in MJCF_WAYS:
        raise ExportError(f"MJCF way {way!r} is unknown; there are {', '.join(MJCF_WAYS)}")
    require_torque(model)
    if not any_status:
        require_usable(model)
    model = bound_friction(model)
    held = find_held_terms(model)
    springs = [term for term in held if isinstance(term, SpringTorque)]
    ripples = [term for term in held if isinstance(term, Cogging)]
    said = (*springs, *(ripples if way == "dcmotor" else ()))
    sliding, joined = join_levels(drop_terms(model, held))
    curves, lost = trusted_curves(sliding), []
    if joined:
        lost.append(f"how friction builds up after a reversal by {', '.join(joined)}")
    silent = (*curves.extra, *(term for term in held if term not in said))
    left_out = [term.name for term in (*sliding.law.terms, *held) if term in silent]
    if left_out:
        lost.append(f"left out: {', '.join(left_out)}")
    if curves.load.load_sensitivity:
        lost.append("friction does not follow the load")
    lost += _lost_lag(curves)
    if curves.forward != curves.reverse:
        lost.append("both directions have their mean friction")
    if way == "dcmotor":
        export = _dcmotor(sliding, curves, lost)
    else:
        export = _damping(sliding, lost) if way == "damping" else _frictionloss(sliding, lost)
    spring = {name: value for term in springs for name, value in _spring(term).items()}
    if ripples and way == "dcmotor":
        export = replace(export, actuator={**export.actuator, "cogging": _cogging(ripples[0])})
    return replace(export, joint={**export.joint, **spring})


def _lost_lag(curves: FrictionCurves) -> list[str]:
    return [f"friction does not lag the velocity, by {curves.lag:g} s in the model"] if curves.lag else []


def _spring(term: SpringTorque) -> dict[str, str]:
    polynomial = f"{term.stiffness:.9g}"
    if term.hardening:
        polynomial += f" 0 {term.stiffness * term.hardening:.9g}"
    return {"stiffness": polynomial, "springref": f"{term.centre:.9g}"}


def _cogging(term: Cogging) -> str:
    """Amplitude, order and phase of the torque that MuJoCo adds: the opposite of what has to be overcome."""
    amplitude, phase = math.hypot(term.sine, term.cosine), math.atan2(-term.cosine, -term.sine)
    return f"{amplitude:.9g} {term.order:.9g} {phase:.9g}"


def _dcmotor(model: FrictionModel, curves: FrictionCurves, lost: list[str]) -> SimulatorExport:
    coulomb, rise, stribeck_velocity, exponent, viscous = np.mean([curves.forward, curves.reverse], axis=0).tolist()
    if exponent != 2.0 and rise:
        lost = [*lost, f"the Stribeck exponent is 2 instead of {exponent:g}"]
    if curves.bristle is not None:
        sigma_0, sigma_1 = curves.bristle.sigma_0, curves.bristle.sigma_1
    else:
        sigma_0 = (coulomb + rise) / _BREAKAWAY_TRAVEL
        sigma_1 = sigma_0 * _BRISTLE_TIME
        lost = [*lost, f"presliding is assumed: breakaway after {_BREAKAWAY_TRAVEL:g} {model.position_unit}"]
    velocity, _ = sample_friction(model)
    speed = np.abs(velocity)
    torque = np.sign(velocity) * (coulomb + rise * np.exp(-((speed / stribeck_velocity) ** 2))) + viscous * velocity
    lugre = (sigma_0, sigma_1, coulomb, coulomb + rise, stribeck_velocity)
    return SimulatorExport(
        joint={"damping": f"{viscous:.9g}", "frictionloss": "0"},
        actuator={"input": "none", "resistance": "1", "lugre": " ".join(f"{value:.9g}" for value in lugre)},
        fidelity=compute_fidelity(model, velocity, torque, tuple(lost)),
    )


def _damping(model: FrictionModel, lost: list[str]) -> SimulatorExport:
    velocity, friction = sample_friction(model)
    basis = np.column_stack([velocity, velocity * np.abs(velocity), velocity**3])
    weights = _fit_passive(basis, friction)
    return SimulatorExport(
        joint={"damping": " ".join(f"{value:.9g}" for value in weights), "frictionloss": "0"},
        fidelity=compute_fidelity(model, velocity, basis @ weights, (*lost, "nothing sticks")),
    )


def _fit_passive(basis: FloatArray, friction: FloatArray) -> FloatArray:
    """Least squares with no negative damping at any speed of the basis; the highest terms go first."""
    for terms in range(basis.shape[1], 0, -1):
        weights = np.linalg.lstsq(basis[:, :terms], friction, rcond=None)[0]
        if np.all((basis[:, :terms] @ weights) * basis[:, 0] >= 0.0) and weights[-1] >= 0.0:
            return np.concatenate([weights, np.zeros(basis.shape[1] - terms)])
    return np.zeros(basis.shape[1])


def _frictionloss(model: FrictionModel, lost: list[str]) -> SimulatorExport:
    velocity, friction = sample_friction(model)
    level, slope = fit_levels(velocity, friction)
    return SimulatorExport(
        joint={"damping": f"{slope:.9g}", "frictionloss": f"{level:.9g}", **_STICKING},
        fidelity=compute_fidelity(
            model, velocity, level * np.sign(velocity) + slope * velocity, (*lost, "no Stribeck effect")
        ),
    )


def export_urdf(model: FrictionModel, *, any_status: bool = False) -> SimulatorExport:
    """The `dynamics` of a URDF joint: a Coulomb level and viscous damping.

    Args:
        model: What is exported.
        any_status: Take a model too that its identification calls unusable.

    Raises:
        ExportError: The model is not in newton metres or newtons.
        ParameterError: The model is not usable.
    """
    levels = fit_friction_levels(model, any_status=any_status)
    return SimulatorExport(
        joint={"damping": f"{levels.viscous:.9g}", "friction": f"{levels.sliding:.9g}"}, fidelity=levels.fidelity
    )


def apply_to_mjcf(export: SimulatorExport, text: str | None, joint: str) -> str:
    """MJCF with the friction of `joint` in it.

    Args:
        export: From `export_mjcf`.
        text: An MJCF file; None for a snippet that holds the joint and the actuator only.
        joint: Name of the joint.

    Raises:
        ExportError: XML does not hold the joint's name, the file is not MJCF or has no such joint, or the joint is no
            hinge of a rotary model or slide of a linear one.
    """
    _require_writable(joint)
    kind = "hinge" if _is_rotary(export) else "slide"
    body = f'<body><joint name={_quote(joint)} type="{kind}"/></body>'
    root = _parse(text if text is not None else f"<mujoco><worldbody>{body}</worldbody></mujoco>", "mujoco")
    element = _find((each for world in root.findall("worldbody") for each in world.iter("joint")), joint)
    _require_kind(joint_type(root, element), (kind,), joint)
    for name in ("damping", "frictionloss", *_STICKING):
        element.attrib.pop(name, None)
    _remove_spring(element)
    element.attrib.update(export.joint)
    if "springref" in export.joint:
        element.append(ET.Comment(_SPRING_NOTE))
        if kind == "hinge" and not _in_radians(root):
            element.attrib["springref"] = f"{math.degrees(float(export.joint['springref'])):.9g}"
    _replace_motor(root, joint, export.actuator)
    return _to_text(root, export)


def _is_rotary(export: SimulatorExport) -> bool:
    return export.fidelity.position_unit == "rad"


def _require_kind(found: str | None, wanted: Sequence[str], joint: str) -> None:
    if found is not None and found not in wanted:
        raise ExportError(
            f"joint {joint!r} in the file to write into is of type {found}; the friction model is of a "
            f"{' or '.join(wanted)} joint: give the model of this one"
        )


def _remove_spring(element: ET.Element) -> None:
    """Take out the spring of an earlier export, not one that the joint had of its own."""
    for note in [each for each in element if each.text == _SPRING_NOTE]:
        element.remove(note)
        for name in ("stiffness", "springref"):
            element.attrib.pop(name, None)


def _replace_motor(root: ET.Element, joint: str, attributes: Mapping[str, str]) -> None:
    """Take out the passive motor of an earlier export, whose friction would add to the new one, and put in another."""
    name = f"{joint}_friction"
    for section in root.findall("actuator"):
        for motor in [each for each in section if each.get("name") in (name, f"{joint}_offset")]:
            section.remove(motor)
    if attributes:
        actuators = root.find("actuator")
        if actuators is None:
            actuators = ET.SubElement(root, "actuator")
        ET.SubElement(actuators, "dcmotor", {"name": name, "joint": joint, **attributes})


def apply_to_urdf(export: SimulatorExport, text: str | None, joint: str) -> str:
    """URDF with the friction of `joint` in it; see `apply_to_mjcf`.

    Raises:
        ExportError: XML does not hold the joint's name, the file is not URDF or has no such joint, or the joint turns
            where the model is linear or slides where it is rotary.
    """
    _require_writable(joint)
    kinds = ("revolute", "continuous") if _is_rotary(export) else ("prismatic",)
    root = _parse(
        text if text is not None else f'<robot><joint name={_quote(joint)} type="{kinds[0]}"/></robot>', "robot"
    )
    element = _find(root.findall("joint"), joint)
    _require_kind(element.get("type"), kinds, joint)
    dynamics = element.find("dynamics")
    if dynamics is None:
        dynamics = ET.SubElement(element, "dynamics")
    dynamics.attrib.update(export.joint)
    return _to_text(root, export)


def _in_radians(root: ET.Element) -> bool:
    """Whether the file's angles are in radians; MJCF says degrees unless told otherwise."""
    return any(compiler.get("angle") == "radian" for compiler in root.iter("compiler"))


def _parse(text: str, root: str) -> ET.Element:
    try:
        parsed = ET.fromstring(text, ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    except ET.ParseError as error:
        raise ExportError(f"the file to write into is not XML: {error}") from error
    if parsed.tag != root:
        raise ExportError(f"the file to write into has <{parsed.tag}> as its root, expected <{root}>")
    return parsed


def _find(joints: Iterable[ET.Element], name: str) -> ET.Element:
    """The joint of that name; elements of other sections, such as <ros2_control> or <equality>, may share it."""
    names = {element.get("name", ""): element for element in joints}
    if name not in names:
        known = ", ".join(map(repr, sorted(filter(None, names)))) or "none"
        raise ExportError(f"the file to write into has no joint {name!r}; it has {known}")
    return names[name]


def _require_writable(joint: str) -> None:
    """XML holds no control characters but in a few places, and turns line ends in a name into blanks."""
    odd = next((sign for sign in joint if unicodedata.category(sign) in ("Cc", "Cs", "Cn")), None)
    if odd is not None:
        raise ExportError(
            f"the joint of the model is called {joint!r}, and no XML file holds {odd!r}: give the model a plain name "
            "(`joint` in its file)"
        )


def _quote(text: str) -> str:
    return f'"{text.replace("&", "&amp;").replace("<", "&lt;").replace(chr(34), "&quot;")}"'


def _to_text(root: ET.Element, export: SimulatorExport) -> str:
    root.insert(0, ET.Comment(f" friction by fricomp: {str(export.fidelity).replace('--', '- -')} "))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
