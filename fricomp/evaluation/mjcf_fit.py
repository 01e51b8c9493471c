"""A model in what MuJoCo can hold: refitted to that, in several ways, and the best of them by simulation.

MuJoCo holds one level of dry friction for both directions, a drag, a ripple of one order and a constant torque. What a
law has beside that, such as friction that follows the load, counts with its mean over the recording.
"""

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fricomp.errors import ExportError
from fricomp.export import MjcfWay, SimulatorExport, apply_to_mjcf, export_mjcf
from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    FrictionLaw,
    LuGre,
    SpringTorque,
    Stribeck,
    StribeckCurve,
    Term,
    Viscous,
)
from fricomp.model import FrictionModel, JointDynamics

from .errors import compare_positions, summarise_positions
from .evaluated import EvaluatedJoint, JointAlong
from .motion import RecordedMotion
from .reading import build_evaluated
from .refit import refit_model
from .result import PositionError
from .settings import EVALUATION, MJCF
from .simulated_joint import SimulatedJoint, read_simulated_joint

_GRAVITY = 9.81  # [m/s²]
_LIGHT = 1e-9  # [kg] and [kg·m²] of what has none
_WAYS: tuple[MjcfWay, ...] = ("dcmotor", "frictionloss")
_BODY = ("inertia", "gravity_cosine", "gravity_sine")


@dataclass(frozen=True)
class MjcfFit:
    """The friction of a joint as MuJoCo holds it.

    Attributes:
        text: The MJCF.
        way: How friction is written: `dcmotor` or `frictionloss`.
        refitted: Whether its numbers were fitted to what MuJoCo can hold; else they are those of the law.
        position: Errors of the simulation, by their length.
        law: Errors of the friction law itself, simulated from the same starts.
        lost: What the file cannot say, in sentences.
    """

    text: str
    way: MjcfWay
    refitted: bool
    position: tuple[PositionError, ...]
    law: tuple[PositionError, ...]
    lost: tuple[str, ...]

    def describe(self) -> str:
        """What the file loses, as a simulation shows it."""
        how = "refitted to what MuJoCo holds" if self.refitted else "the numbers of the law"
        text = f"{self.way}, {how}"
        for mine, law in zip(self.position[:1], self.law[:1], strict=False):
            text += (
                f"; simulated from measured states it is off by {mine.median:.3g} {mine.unit} after {mine.after:g} s "
                f"(median), friction.json by {law.median:.3g} {law.unit}"
            )
        return "; ".join([text, *self.lost])


def fit_mjcf(
    model: FrictionModel, motion: RecordedMotion, simulation: str | None = None, joint: str | None = None
) -> MjcfFit:
    """Write friction into an MJCF file, in the way that moves most like the recorded joint.

    Args:
        model: Friction with its dynamics.
        motion: The recording.
        simulation: Text of an MJCF file to write into; its inertia and gravity stay. A joint is made from the model's
            dynamics if None.
        joint: Name of the joint in it.

    Raises:
        ExportError: The model is in another unit than newton metres or newtons, or has no dynamics.
        SimulationFileError: The file cannot be simulated.
    """
    if model.dynamics is None:
        raise ExportError("a model is fitted to MuJoCo with its inertia and gravity: give it its dynamics")
    name = joint or model.joint
    text = simulation or _write_joint(model.dynamics, name, model.motion)
    plain = export_mjcf(model)
    found = [_Candidate(apply_to_mjcf(plain, text, name), "dcmotor", False, plain.fidelity.lost)]
    found += _refit(model, motion, text, name)
    short = _shorten(motion)
    errors = [_simulate(_read(one.text, name), short) for one in found]
    best = int(np.argmin([each[0].median if each else math.inf for each in errors]))
    chosen = found[best]
    law = _simulate(build_evaluated(model, "friction.json"), short)
    return MjcfFit(chosen.text, chosen.way, chosen.refitted, errors[best], law, chosen.lost)


@dataclass(frozen=True)
class _Candidate:
    text: str
    way: MjcfWay
    refitted: bool
    lost: tuple[str, ...]


def _refit(model: FrictionModel, motion: RecordedMotion, text: str, name: str) -> list[_Candidate]:
    """The law in MuJoCo's words, all numbers fitted to the recording with the body of the file."""
    body = _read(text, name).measure_dynamics()
    result = []
    for way in _WAYS:
        restricted = replace(model.with_law(_restrict(model.law, way)), dynamics=body)
        fitted = refit_model(restricted, [motion], held=(*_BODY, *_hold_exponents(restricted)), fold=False).model
        export = export_mjcf(fitted, way)
        lost = tuple(_list_lost(model.law, export))
        assert fitted.dynamics is not None
        written = _add_constant(apply_to_mjcf(export, text, name), name, fitted.dynamics.offset - body.offset)
        result.append(_Candidate(written, way, True, lost))
    return result


def _restrict(law: FrictionLaw, way: MjcfWay) -> FrictionLaw:
    """What MuJoCo holds of a law, from which it is refitted."""
    core = next((term for term in law.terms if isinstance(term, BidirectionalStribeck | LuGre)), None)
    kept: list[Term] = []
    if core is not None:
        forward, reverse = core.forward, core.reverse
        names = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")
        mean = [0.5 * (getattr(forward, one) + getattr(reverse, one)) for one in names]
        if way == "frictionloss":
            kept += [Coulomb(max(mean[0], 1e-9)), Viscous(max(mean[3], 0.0))]
        elif isinstance(core, LuGre):
            curve = StribeckCurve(*mean)
            kept.append(LuGre(curve, curve, core.sigma_0, core.sigma_1))
        else:
            kept.append(Stribeck(StribeckCurve(*mean)))
    else:
        kept += [term for term in law.terms if isinstance(term, Coulomb | Viscous | Stribeck)]
    ripples = [term for term in law.terms if isinstance(term, Cogging)]
    if ripples and way == "dcmotor":
        strongest = max(ripples, key=lambda one: math.hypot(one.sine, one.cosine))
        kept.append(Cogging(strongest.sine, strongest.cosine, strongest.order))
    kept += [term for term in law.terms if isinstance(term, SpringTorque)]
    if not kept:
        raise ExportError("MuJoCo holds nothing of this law: use friction.json")
    return FrictionLaw(tuple(kept))


def _hold_exponents(model: FrictionModel) -> tuple[str, ...]:
    """MuJoCo's friction falls as a Gaussian of the speed."""
    return tuple(name for name in model.law.parameters() if name.endswith("stribeck_exponent"))


def _list_lost(law: FrictionLaw, export: SimulatorExport) -> list[str]:
    said = ("stribeck", "symmetric_stribeck", "lugre", "coulomb", "viscous", "cogging", "spring_torque")
    lost = [one for one in export.fidelity.lost if "directions" not in one and "left out" not in one]
    mean = [term.name for term in law.terms if term.name not in said]
    return [*lost, *([f"with their mean over the recording only: {', '.join(mean)}"] if mean else [])]


def _add_constant(text: str, joint: str, torque: float) -> str:
    """A constant torque beside the friction: half of what the directions differ by."""
    root = ET.fromstring(text, ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    actuators = root.find("actuator")
    if actuators is None:
        actuators = ET.SubElement(root, "actuator")
    name = f"{joint}_offset"
    for old in [each for each in actuators if each.get("name") == name]:
        actuators.remove(old)
    values = {"gainprm": "0", "biastype": "affine", "biasprm": f"{-torque:.9g} 0 0"}
    ET.SubElement(actuators, "general", {"name": name, "joint": joint, **values})
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _write_joint(dynamics: JointDynamics, joint: str, motion: str) -> str:
    """MJCF of a joint with this inertia and gravity: a mass on an arm short enough to have at most half of it."""
    kind, axis = ("hinge", "0 1 0") if motion == "rotary" else ("slide", "1 0 0")
    gravity = math.hypot(dynamics.gravity_cosine, dynamics.gravity_sine)
    reach = 0.5 * _GRAVITY * dynamics.inertia / gravity if gravity else 0.0
    mass = gravity / (_GRAVITY * reach) if gravity else _LIGHT
    x, z = (-reach * part / gravity if gravity else 0.0 for part in (dynamics.gravity_cosine, dynamics.gravity_sine))
    armature = dynamics.inertia - mass * reach**2
    name = joint.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return (
        f'<mujoco><option timestep="0.001" gravity="0 0 {-_GRAVITY}" integrator="implicitfast"/><worldbody><body>'
        f'<inertial pos="{x:.12g} 0 {z:.12g}" mass="{mass:.12g}" diaginertia="{_LIGHT} {_LIGHT} {_LIGHT}"/>'
        f'<joint name="{name}" type="{kind}" axis="{axis}" armature="{armature:.12g}"/></body></worldbody></mujoco>'
    )


def _shorten(motion: RecordedMotion) -> RecordedMotion:
    """The first so many seconds of a recording: they tell one way from another as well as all of it."""
    parts, left = [], MJCF.duration
    for part in motion.parts:
        rows = slice(0, round(left / part.dt))
        if left * part.dt >= 0.0 and part.time[rows].size * part.dt > EVALUATION.shortest_part:
            names = ("time", "position", "velocity", "smooth_velocity", "acceleration", "torque", "moves")
            cut = {name: getattr(part, name)[rows] for name in names}
            parts.append(replace(part, **cut, channels={name: v[rows] for name, v in part.channels.items()}))
        left -= part.time.size * part.dt
        if left <= 0.0:
            break
    return replace(motion, parts=tuple(parts) or motion.parts[:1])


def _simulate(joint: EvaluatedJoint, motion: RecordedMotion) -> tuple[PositionError, ...]:
    return summarise_positions(motion, compare_positions(motion, JointAlong(joint, motion).simulate, None, MJCF.starts))


def _read(text: str, joint: str) -> SimulatedJoint:
    with TemporaryDirectory(prefix="fricomp-") as folder:
        path = Path(folder) / "joint.xml"
        path.write_text(text, encoding="utf-8")
        return read_simulated_joint(path, joint)
