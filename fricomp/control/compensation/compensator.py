"""The compensator: friction torque to add to a command, for one joint or many."""

from __future__ import annotations

import os
from collections.abc import Callable, MutableSequence, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.hot_path import HotPath, TorqueFunction, build_hot_path
from fricomp.control.compensation.trust import require_usable, trusted_curves
from fricomp.control.settings import CompensationSettings, LoopDynamics
from fricomp.errors import ModelFileError, ParameterError
from fricomp.laws import find_inputs
from fricomp.model import FrictionModel, load_model
from fricomp.model.given import take_model

if TYPE_CHECKING:
    from fricomp.control.compensation.arm_load import ArmLoad

__all__ = ["ArmCompensator", "Compensator", "require_one_each"]

ModelSource = FrictionModel | str | os.PathLike[str]


class Compensator:
    """Friction compensation of one joint, a plain function of floats underneath.

    A joint obeys J a = tau - F(v) - ..., with friction F(v) against its motion. A compensator adds an estimate of that
    friction to the command, so that the controller has only the rest to do:

        tau = tau_controller + gain (tanh(x / smoothing) dry(|v|) + viscous x)        [N·m] or [N]

    with the velocity x [rad/s] or [m/s] of the reference, of the measurement, or of both. Three numbers keep it from
    doing harm. The `gain` is at most 1 and falls with the uncertainty of the model: a torque above the true friction
    pushes the joint and makes it oscillate. `smoothing` replaces the jump at rest, which a delay would turn into
    chatter. `authority` bounds the result by the largest friction of the model.

    Friction of 0.2 N·m and 0.1 N·m·s/rad, at 0.5 rad/s:

    >>> from fricomp import Compensator, FrictionLaw, FrictionModel
    >>> from fricomp.laws import Coulomb, Viscous
    >>> from fricomp.model import Validity
    >>> law = FrictionLaw((Coulomb(0.2), Viscous(0.1)))
    >>> model = FrictionModel(law, validity=Validity(velocity=(-2.0, 2.0)))
    >>> compensator = Compensator(model, period=1e-3, gain=0.9)
    >>> round(compensator.torque(0.5), 4)  # 0.9 (0.2 + 0.1 · 0.5)
    0.225
    >>> compensator.torque(0.0)  # at rest friction may point either way
    0.0
    >>> controller_torque = 1.5
    >>> command = controller_torque + compensator.torque(0.5)

    `fricomp.control.settings.CompensationSettings` has the whole equation; `describe()` says what was chosen and why.

    Attributes:
        torque: The compensation; see `TorqueFunction` for its arguments. It is kept as a function of its own, so
            that calling it costs no method lookup.
        model: What is compensated.
        settings: How; `settings.notes` says why.
        inputs: What the model depends on besides velocity, and has to be told, of `position`, `load_torque`,
            `normal_load` (the size of the transmitted torque), `temperature` and `acceleration`.

    Args:
        model: A model, the result that holds it, or the path of its file (`friction.json`).
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
        self.inputs = _list_inputs(self.model)
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
            f"Joint {self.model.joint}: direction from the {source}, gain {s.gain:.3f}, smoothing {s.smoothing:.3g} "
            f"{self.model.position_unit}/s, at most {s.authority:.3g} {self.model.torque_unit}."
        )
        return "\n".join([head, *(f"- {note}" for note in s.notes)])


class ArmCompensator:
    """Friction compensation of several joints, with the load that each transmits from the arm's own dynamics.

    arm = ArmCompensator.read("runs/arm", period=1e-3)
    arm.torque_into(out, velocity_reference, velocity, position_error, None, position, acceleration)
    command = [friction + rest for friction, rest in zip(out, arm.feed_forward)]

    Attributes:
        joints: One compensator a joint.
        load: Torque that each joint transmitted in the last call [N·m] or [N]; empty without `dynamics`.
        feed_forward: The same with what accelerates the rotors, which lie before the gears: all of gravity and inertia
            that a motor has to give [N·m] or [N].

    Args:
        joints: One compensator a joint, in the order of the command.
        dynamics: Who knows the load; needed where a model depends on it.

    Raises:
        ParameterError: No joint, one compensator twice, another number of joints than `dynamics` has, or a model that
            depends on what nobody tells it.
    """

    def __init__(self, joints: Sequence[Compensator], dynamics: ArmLoad | None = None) -> None:
        if not joints:
            raise ParameterError("an arm needs at least one joint")
        require_one_each(joints)
        known = {"normal_load", *(("position", "load_torque", "acceleration", "temperature") if dynamics else ())}
        for compensator in joints:
            if untold := compensator.inputs - known:
                raise ParameterError(
                    f"the model of joint {compensator.model.joint!r} depends on {', '.join(sorted(untold))}: give "
                    "dynamics=ArmLoad(simulation), or call `Compensator.torque` of each joint with them, or use a "
                    "ControlLoop"
                )
        if dynamics is not None and len(dynamics.joints) != len(joints):
            raise ParameterError(
                f"the dynamics are of {len(dynamics.joints)} joints, the compensators of {len(joints)}"
            )
        self.joints = tuple(joints)
        self.load: Sequence[float] = ()
        self.feed_forward: Sequence[float] = ()
        self._torques: list[Callable[..., float]] = [joint.torque for joint in joints]
        self._indices, self._unknown = range(len(joints)), [None] * len(joints)
        self._dynamics = dynamics
        self._takes_normal = [dynamics is not None and "normal_load" in joint.inputs for joint in joints]

    @classmethod
    def read(cls, folder: str | os.PathLike[str], *, period: float = 1e-3, **given: Any) -> Self:
        """The compensation of an arm from the folder that `fricomp diagnose` wrote of it.

        Args:
            folder: With `arm.xml` and `joints/NAME/friction.json`.
            period: Control period [s].
            given: Further arguments of `Compensator`, the same for every joint.

        Raises:
            ModelFileError: A model cannot be read, or there is none.
            SimulationFileError: The simulation cannot be read, or lacks a joint.
            MissingExtraError: MuJoCo is not installed.
        """
        from fricomp.control.compensation.arm_load import ArmLoad

        models = {model.joint: model for model in map(load_model, sorted(Path(folder).glob("joints/*/friction.json")))}
        if not models:
            raise ModelFileError(
                f"{folder} has no joints/NAME/friction.json: give a folder of fricomp diagnose on an arm"
            )
        order = [name for name in ArmLoad(Path(folder) / "arm.xml").joints if name in models]
        dynamics = ArmLoad(Path(folder) / "arm.xml", order + [name for name in models if name not in order])
        return cls([Compensator(models[name], period=period, **given) for name in dynamics.joints], dynamics)

    def torque_into(
        self,
        out: MutableSequence[float],
        velocity_reference: Sequence[float],
        velocity: Sequence[float] | None = None,
        position_error: Sequence[float] | None = None,
        normal_load: Sequence[float] | None = None,
        position: Sequence[float] | None = None,
        acceleration: Sequence[float] | None = None,
        temperature: Sequence[float] | None = None,
    ) -> None:
        """Fill `out` with the compensation of each joint; the inputs are those of `TorqueFunction`, one a joint.

        With `dynamics` the position is needed, and the load is that of the position, of `velocity_reference` and of
        `acceleration`, which is none where it is not given.

        Raises:
            ParameterError: An input has another number of joints, or no position is given.
        """
        torques, unknown = self._torques, self._unknown
        v = unknown if velocity is None else velocity
        e = unknown if position_error is None else position_error
        n = unknown if normal_load is None else normal_load
        if not len(out) == len(torques) == len(velocity_reference) == len(v) == len(e) == len(n):
            given = [len(values) for values in (out, velocity_reference, v, e, n)]
            raise ParameterError(f"{given} values given for {len(torques)} joints")
        if self._dynamics is not None:
            self._follow_load(out, velocity_reference, v, e, n, position, acceleration, temperature)
            return
        for j in self._indices:  # on lists cheaper than any zip or map
            out[j] = torques[j](velocity_reference[j], v[j], e[j], n[j])

    def _follow_load(
        self,
        out: MutableSequence[float],
        velocity_reference: Sequence[float],
        v: Sequence[float | None],
        e: Sequence[float | None],
        n: Sequence[float | None],
        position: Sequence[float] | None,
        acceleration: Sequence[float] | None,
        temperature: Sequence[float] | None,
    ) -> None:
        assert self._dynamics is not None
        torques, q = self._torques, position
        if q is None:
            raise ParameterError("the load of an arm follows its position: give position= [rad] or [m], one a joint")
        a = [0.0] * len(torques) if acceleration is None else acceleration
        hot = self._unknown if temperature is None else temperature
        self.load = load = self._dynamics.compute(q, velocity_reference, a)
        self.feed_forward = [one + rotor * b for one, rotor, b in zip(load, self._dynamics.rotors, a, strict=True)]
        if len(hot) != len(torques):
            raise ParameterError(f"{len(hot)} temperatures given for {len(torques)} joints")
        normal = self._takes_normal
        for j in self._indices:
            pressed = abs(load[j]) if normal[j] and n[j] is None else n[j]
            out[j] = torques[j](velocity_reference[j], v[j], e[j], pressed, q[j], load[j], hot[j], a[j])

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


def _list_inputs(model: FrictionModel) -> frozenset[str]:
    # A normal load in any other unit than the joint's torque is known to the user alone.
    transmitted = "transmitted" in model.provenance.notes.get("normal_load", "")
    return find_inputs(model.law.terms) | ({"normal_load"} if transmitted else set())


def _read(model: ModelSource) -> FrictionModel:
    taken = take_model(model)
    if isinstance(taken, FrictionModel):
        return taken
    if taken.suffix == ".onnx":
        raise ParameterError(
            f"{model} is a network: use NetworkCompensator, or the closed form beside it (friction.json)"
        )
    return load_model(taken)
