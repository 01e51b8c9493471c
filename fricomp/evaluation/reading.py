"""A model as users have it: an object, a file, or the folder that a command has written."""

import os
from dataclasses import replace
from pathlib import Path

from fricomp.errors import ModelFileError
from fricomp.laws import FrictionLaw
from fricomp.model import FrictionModel, load_model

from .equation import JointEquation
from .evaluated import EquationJoint, EvaluatedJoint
from .network import NetworkTerm
from .simulated_joint import SimulatedJoint, read_simulated_joint

Source = str | os.PathLike[str]

_SIMULATIONS = (".xml", ".mjcf", ".urdf")
_FRICTION = "friction.json"


def read_model(
    model: FrictionModel | Source, *, simulation: Source | None = None, joint: str | None = None, named: bool = False
) -> EvaluatedJoint:
    """Read what is to be evaluated.

    Args:
        model: A friction model, its file, a simulation, or a folder with `friction.json`.
        simulation: MJCF or URDF file with the rigid body of a friction model.
        joint: Name of the joint in a simulation.
        named: Whether a simulation must have a joint of that name; else its only joint will do.

    Raises:
        ModelFileError: It cannot be read, or nothing says what inertia and gravity are.
        SimulationFileError: The simulation cannot be read, or has no such joint.
    """
    if isinstance(model, FrictionModel):
        return build_evaluated(model, "the model", _read_simulation(simulation, joint, named=named))
    path = Path(model)
    if path.is_dir():
        path = path / _FRICTION
    if not path.is_file():
        raise ModelFileError(
            f"there is no model {path}: give friction.json, friction.onnx, an MJCF or URDF file, or the folder of a "
            "diagnosis"
        )
    if path.suffix.lower() in _SIMULATIONS:
        if simulation is not None:
            raise ModelFileError(f"{path} is a simulation itself: leave out the other one, {os.fspath(simulation)}")
        return read_simulated_joint(path, joint, named=named)
    body = _read_simulation(simulation, joint, named=named)
    if path.suffix.lower() == ".onnx":
        return _read_network(path, body)
    return build_evaluated(load_model(path), path.name, body)


def build_evaluated(model: FrictionModel, name: str, body: SimulatedJoint | None = None) -> EquationJoint:
    """The joint equation of a friction model.

    Args:
        model: Friction, and the rigid body where it has one.
        name: What it is called in the answer.
        body: Simulation whose rigid body is taken instead; None for the model's own.

    Raises:
        ModelFileError: Nothing says what inertia and gravity are, or the simulation is in another unit.
    """
    if body is None:
        if model.dynamics is None:
            raise ModelFileError(
                f"{name} holds friction alone, and inertia and gravity move the joint as well: give the simulation "
                "that has them (--simulation FILE)"
            )
        return EquationJoint(name, model.motion, model.torque_unit, (), JointEquation(model.law, model.dynamics))
    if (body.motion, body.torque_unit) != (model.motion, model.torque_unit):
        raise ModelFileError(
            f"{name} is of a {model.motion} joint in {model.torque_unit}, the simulation has a {body.motion} one in "
            f"{body.torque_unit}: give the simulation of this joint"
        )
    law, spring = model.law, body.read_spring()
    if spring is not None and all(term.name != spring.name for term in law.terms):
        law = law.with_term(spring)
    dynamics, own = body.measure_dynamics(), model.dynamics
    if own is not None:  # what no simulation has
        dynamics = replace(
            dynamics, load_inertia=min(own.load_inertia, dynamics.inertia), torque_delay=own.torque_delay
        )
    notes = (*body.notes, f"Inertia {dynamics.inertia:.4g} and gravity are those of the simulation.")
    return EquationJoint(
        f"{name} with {body.name}", model.motion, model.torque_unit, notes, JointEquation(law, dynamics)
    )


def _read_simulation(path: Source | None, joint: str | None, *, named: bool) -> SimulatedJoint | None:
    return None if path is None else replace(read_simulated_joint(Path(path), joint, named=named), name=Path(path).name)


def _read_network(path: Path, body: SimulatedJoint | None) -> EquationJoint:
    """A network of friction; its rigid body is that of the simulation, or of the `friction.json` beside it."""
    beside = path.with_name(_FRICTION)
    if body is None and not beside.is_file():
        raise ModelFileError(
            f"{path.name} holds friction alone, and there is no {_FRICTION} beside it: give the simulation that has "
            "inertia and gravity (--simulation FILE)"
        )
    term = NetworkTerm(path)
    if beside.is_file():
        model = load_model(beside)
    else:
        assert body is not None
        model = FrictionModel(FrictionLaw((term,)), motion=body.motion, torque_unit=body.torque_unit)
    return build_evaluated(model.with_law(FrictionLaw((term,))), path.name, body)
