"""The compensator: friction torque to add to a command, for one joint or many."""

from __future__ import annotations

import os
from collections.abc import Callable, MutableSequence, Sequence
from pathlib import Path
from typing import Any

from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.hot_path import HotPath, TorqueFunction, build_hot_path
from fricomp.control.compensation.trust import require_usable, trusted_curves
from fricomp.control.settings import CompensationSettings, LoopDynamics
from fricomp.errors import ParameterError
from fricomp.laws import find_inputs
from fricomp.model import FrictionModel, load_model

__all__ = ["ArmCompensator", "Compensator", "require_one_each"]

ModelSource = FrictionModel | str | os.PathLike[str]


class Compensator:
    """Friction compensation of one joint, a plain function of floats underneath.

    c = Compensator("friction.json", period=1e-3)
    command = controller_output + c.torque(velocity_reference)

    Attributes:
        torque: The compensation; see `TorqueFunction` for its arguments. It is kept as a function of its own, so
            that calling it costs no method lookup.
        model: What is compensated.
        settings: How; `settings.notes` says why.
        inputs: What the model depends on besides velocity, and has to be told, of `position`, `load_torque`,
            `normal_load` (the size of the transmitted torque), `temperature` and `acceleration`.

    Args:
        model: A model or the path of its file (`friction.json`).
        period: Control period [s].
        loop: The position loop around the joint, where known; decides whether its damping holds a falling branch.
        velocity_quantum: Step of the measured velocity [rad/s] or [m/s].
        settings: All settings at once, instead of choosing them.
        any_status: Take a model too that its identification calls unusable, such as `not_identifiable`.
        given: Single fields of `CompensationSettings` that are not to be chosen.

    Raises:
        ModelFileError: The file cannot be read.
        ParameterError: A setting or the period is outside its domain, or the model is not usable.
    """

    torque: TorqueFunction

    def __init__(
        self,
        model: ModelSource,
        *,
        period: float = 1e-3,
        loop: LoopDynamics | None = None,
        velocity_quantum: float = 0.0,
        settings: CompensationSettings | None = None,
        any_status: bool = False,
        **given: Any,
    ) -> None:
        if not 0.0 < period < 10.0:
            raise ParameterError(f"the period must be positive and below 10 s, got {period!r}")
        if settings is not None and given:
            raise ParameterError(f"give either settings or single fields, not both: {sorted(given)}")
        self.model = _read(model)
        if not any_status:
            require_usable(self.model)
        self.period = period
        self.settings = settings or choose_settings(self.model, loop=loop, velocity_quantum=velocity_quantum, **given)
        self.inputs = _inputs(self.model)
        curves = trusted_curves(self.model)
        self._hot: HotPath = build_hot_path(curves, self.settings, period)
        self.torque = self._hot.torque

    @property
    def rejected(self) -> int:
        """How many inputs so far were no finite numbers, or missing, and got 0.0."""
        return self._hot.rejected()

    @property
    def rejection(self) -> str:
        """Why the last of them was; empty where none was."""
        return self._hot.rejection()

    def reset(self) -> None:
        """Forget the bristle, rests and the last torque; call it when the loop starts again."""
        self._hot.reset()

    def set_scale(self, dry: float, viscous: float) -> None:
        """Multiply dry and viscous friction, as online adaptation does [1]."""
        self._hot.set_scale(dry, viscous)

    def describe(self) -> str:
        """What is compensated and why so, in sentences."""
        s = self.settings
        source = "measured velocity" if s.source == "measured" else "reference"
        head = (
            f"Joint {self.model.joint}: direction from the {source},"
            f" gain {s.gain:.3f}, smoothing {s.smoothing:.3g}, at most {s.authority:.3g} {self.model.torque_unit}."
        )
        return "\n".join([head, *(f"- {note}" for note in s.notes)])


class ArmCompensator:
    """Friction compensation of several joints.

    Args:
        joints: One compensator a joint, in the order of the command.

    Raises:
        ParameterError: No joint, one compensator twice, or a model that depends on what `torque_into` is not told.
    """

    def __init__(self, joints: Sequence[Compensator]) -> None:
        if not joints:
            raise ParameterError("an arm needs at least one joint")
        require_one_each(joints)
        for compensator in joints:
            if untold := compensator.inputs - {"normal_load"}:
                raise ParameterError(
                    f"the model of joint {compensator.model.joint!r} depends on {', '.join(sorted(untold))}: call "
                    f"`Compensator.torque` of each joint with them, or use a ControlLoop"
                )
        self.joints = tuple(joints)
        self._torques: list[Callable[..., float]] = [joint.torque for joint in joints]
        self._indices, self._unknown = range(len(joints)), [None] * len(joints)

    def torque_into(
        self,
        out: MutableSequence[float],
        velocity_reference: Sequence[float],
        velocity: Sequence[float] | None = None,
        position_error: Sequence[float] | None = None,
        normal_load: Sequence[float] | None = None,
    ) -> None:
        """Fill `out` with the compensation of each joint; the inputs are those of `TorqueFunction`, one a joint.

        Raises:
            ParameterError: An input has another number of joints.
        """
        torques, unknown = self._torques, self._unknown
        v = unknown if velocity is None else velocity
        e = unknown if position_error is None else position_error
        n = unknown if normal_load is None else normal_load
        if not len(out) == len(torques) == len(velocity_reference) == len(v) == len(e) == len(n):
            given = [len(values) for values in (out, velocity_reference, v, e, n)]
            raise ParameterError(f"{given} values given for {len(torques)} joints")
        for j in self._indices:  # on lists cheaper than any zip or map
            out[j] = torques[j](velocity_reference[j], v[j], e[j], n[j])

    @property
    def rejected(self) -> int:
        """How many inputs of any joint so far were not finite."""
        return sum(joint.rejected for joint in self.joints)

    def reset(self) -> None:
        """Forget the state of every joint."""
        for joint in self.joints:
            joint.reset()


def require_one_each(compensators: Sequence[Compensator]) -> None:
    """Refuse one compensator for several joints: bristle, lag, rests and scale are those of one.

    Raises:
        ParameterError: One comes twice.
    """
    if len({id(compensator) for compensator in compensators}) != len(compensators):
        raise ParameterError("a compensator keeps the state of one joint: make one for each")


def _inputs(model: FrictionModel) -> frozenset[str]:
    # A normal load in any other unit than the joint's torque is known to the user alone.
    transmitted = "transmitted" in model.provenance.notes.get("normal_load", "")
    return find_inputs(model.law.terms) | ({"normal_load"} if transmitted else set())


def _read(model: ModelSource) -> FrictionModel:
    if isinstance(model, FrictionModel):
        return model
    if Path(model).suffix == ".onnx":
        raise ParameterError(
            f"{model} is a network: use NetworkCompensator, or the closed form beside it (friction.json)"
        )
    return load_model(Path(model))
