"""The sine of `fricomp run` on an open adapter: the loop that follows it, and the compensators chosen for that loop."""

from dataclasses import replace
from typing import Any, NamedTuple

from fricomp.adapters import AdapterOptions, JointAdapter, recording_metadata
from fricomp.cli.terminal import console
from fricomp.control import (
    Compensator,
    ControlLoop,
    LoopDynamics,
    LoopResult,
    PositionController,
    RealTimeOptions,
    SineReference,
)
from fricomp.control.compensation.authority import compute_breakaway
from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback, await_feedback
from fricomp.model import FrictionModel
from fricomp.recording import RecordingMetadata

REST = 0.5
"""Before the motion, while the enable ramp opens [s]."""


class Sine(NamedTuple):
    """The motion: amplitude [rad] or [m], frequency [Hz], number of cycles."""

    amplitude: float
    frequency: float
    cycles: float

    @property
    def duration(self) -> float:
        """With the rest before it [s]."""
        return self.cycles / self.frequency + REST


class LoopSetup:
    """An open adapter with the loop that is closed over it.

    Args:
        adapter: Open.
        models: Of each joint, in the order of the bus.
        inertia: At each joint [kg·m²] or [kg]; one value serves all.
        loop: Bandwidth of the position loop [Hz], delay [s], time constant of the velocity filter [s].
        period: Of the loop [s].

    Raises:
        ParameterError: Models or inertias are not as many as the joints.
    """

    def __init__(
        self,
        adapter: JointAdapter,
        models: list[FrictionModel],
        inertia: list[float],
        loop: tuple[float, float, float],
        period: float,
    ) -> None:
        n = len(adapter.capabilities.joints)
        if len(models) != n or len(inertia) not in (1, n):
            raise ParameterError(
                f"the bus needs {n} of each: give as many models (got {len(models)}), and one inertia for all or one "
                f"for each (got {len(inertia)})"
            )
        self._stated = [limit.breakaway is not None for limit in adapter.options.limits]
        adapter.options = add_breakaway(adapter, models)
        bandwidth, *self.lags = loop
        self.adapter, self.models, self.period = adapter, models, period
        self.controller = PositionController.from_bandwidth(inertia * (n // len(inertia)), bandwidth)

    def explain_standing(self, result: LoopResult) -> str:
        """Whose friction the limit is by which a joint stands too long; nothing of any other stop."""
        if result.trip is None or result.trip.reason != "frozen":
            return ""
        limits, joints = self.adapter.options.limits, self.adapter.capabilities.joints
        whose = [
            f"{limit.breakaway:.4g} of joint {joint.name!r} by the model of {model.joint!r}"
            for limit, stated, joint, model in zip(limits, self._stated, joints, self.models, strict=True)
            if not stated and limit.breakaway is not None
        ]
        if not whose:
            return ""
        return (
            f". That limit is what the model says of its own joint ({', '.join(whose)}): where it is of another joint, "
            "or was identified on another, give the model of the one that moves, or state breakaway in --config"
        )

    def choose_compensators(self, gain: float | None) -> list[Compensator]:
        """One a joint, chosen for its loop; each says what it does."""
        given: dict[str, Any] = {} if gain is None else {"gain": gain}
        quanta = [joint.velocity_quantum for joint in self.adapter.capabilities.joints]
        made = [
            Compensator(model, period=self.period, loop=self._dynamics(joint), velocity_quantum=quantum, **given)
            for joint, (model, quantum) in enumerate(zip(self.models, quanta, strict=True))
        ]
        for one in made:
            console().print(one.describe())
        return made

    def _dynamics(self, joint: int) -> LoopDynamics:
        c = self.controller
        return LoopDynamics(c.inertia[joint], c.stiffness[joint], c.damping[joint], *self.lags)

    def build_loop(self, sine: Sine, compensators: list[Compensator] | None, priority: int) -> ControlLoop:
        """The loop that follows the sine, from where the joints are, towards the middle of their range.

        Raises:
            ParameterError: It would leave the range.
        """
        capabilities = self.adapter.capabilities
        feedback = JointFeedback(len(capabilities.joints))
        self.adapter.configure("torque", self.period)
        await_feedback(self.adapter, feedback, self.period)
        amplitudes = [
            _turn_inwards(sine.amplitude, start, facts)
            for facts, start in zip(self.read_metadata(), feedback.position, strict=True)
        ]
        return ControlLoop(
            self.adapter,
            SineReference(amplitudes, sine.frequency, list(feedback.position), rest=REST),
            self.controller,
            compensators=compensators,
            period=self.period,
            log_capacity=round(sine.duration / self.period) + 1,
            options=None if capabilities.simulated else RealTimeOptions(priority=priority, lock_memory=True),
        )

    def read_metadata(self) -> list[RecordingMetadata]:
        """Of each joint's recording."""
        joints = range(len(self.adapter.capabilities.joints))
        return [recording_metadata(self.adapter, joint, "fricomp run") for joint in joints]


def add_breakaway(adapter: JointAdapter, models: list[FrictionModel]) -> AdapterOptions:
    """The adapter's options, where no breakaway limit is configured with that of the joint's model."""
    limits = []
    for limit, model, joint in zip(adapter.options.limits, models, adapter.capabilities.joints, strict=True):
        known = limit.breakaway is None and model.torque_unit == joint.torque_unit
        limits.append(replace(limit, breakaway=compute_breakaway(model)) if known else limit)
    return replace(adapter.options, limits=tuple(limits))


def _turn_inwards(amplitude: float, start: float, facts: RecordingMetadata) -> float:
    """The amplitude with the sign that leads from `start` towards the middle of the joint's range.

    Raises:
        ParameterError: The motion, twice the amplitude, would leave the range.
    """
    if facts.position_limits is None:
        return amplitude
    low, high = facts.position_limits
    signed = -amplitude if start > (low + high) / 2.0 else amplitude
    if not low < start + 2.0 * signed < high:
        raise ParameterError(
            f"joint {facts.joint!r} is at {start:.4g} and would be moved to {start + 2.0 * signed:.4g}, outside its "
            f"limits {low:g} to {high:g}: lower --amplitude, or move the joint towards the middle"
        )
    return signed
