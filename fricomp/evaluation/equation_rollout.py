"""The equation of a joint, simulated from many states at once under the recorded torque.

Over a step of h the velocity w solves J (w - v)/h + c (v + w)/2 + b (w - u) + F sgn(w) = net, where F is the level of
dry friction, c the drag, and b the slope of bristles about the velocity u: F may hold the joint, which then rests, so
that nothing chatters. Drag and position take the mean of both ends, so that neither is late by half a step.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.laws import Dahl, FloatArray, FrictionLaw, LuGre, SpringTorque
from fricomp.laws.end_stop import EndStop

from .equation import JointEquation, advance_states, align_torque, resist
from .motion import Index, MotionPart
from .settings import EVALUATION


@dataclass
class _State:
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    memory: tuple[FloatArray, ...]


def simulate_equation(
    equation: JointEquation, part: MotionPart, states: Sequence[FloatArray], starts: Index, lengths: Sequence[int]
) -> FloatArray:
    """Position of the model after so many samples from each start [rad] or [m]. Shape (n_lengths, n_starts).

    Args:
        equation: The joint.
        part: Its recorded motion; the torque of it drives the model.
        states: Of the terms along it, from `JointEquation.follow`.
        starts: Samples at which the model is in the recorded state.
        lengths: Numbers of samples, rising.
    """
    top = max(float(np.quantile(np.abs(part.velocity), EVALUATION.top)), 1e-9)
    substeps = count_substeps(equation.law, equation.inertia, part.dt, top)
    torque = align_torque(part, equation.dynamics.torque_delay)
    state = _State(
        part.position[starts],
        part.velocity[starts],
        np.zeros(starts.size),
        tuple(one[:, starts] for one in states),
    )
    result = np.empty((len(lengths), starts.size))
    last = part.time.size - 1
    with np.errstate(all="ignore"):  # a model that runs away overflows; its error is counted as such
        for k in range(lengths[-1]):
            here, there = np.minimum(starts + k, last), np.minimum(starts + k + 1, last)
            channels = {name: values[here] for name, values in part.channels.items()}
            for j in range(substeps):
                share = (j + 0.5) / substeps
                drive = torque[here] + share * (torque[there] - torque[here])
                _advance(equation, state, drive, channels, part.dt / substeps, top)
            for i, length in enumerate(lengths):
                if length == k + 1:
                    result[i] = state.position
    return result


def _advance(
    equation: JointEquation,
    state: _State,
    drive: FloatArray,
    channels: Mapping[str, FloatArray],
    h: float,
    top: float,
) -> None:
    """One step of all simulations; `drive` is the mean torque over it [N·m]."""
    v, q = state.velocity, state.position + 0.5 * h * state.velocity
    ahead = v + 0.5 * h * state.acceleration
    ahead = np.where(ahead * v > 0.0, ahead, v)
    point = equation.compute_point(q, ahead, state.acceleration, channels)
    found = resist(equation.law, point, state.memory, h, top)
    heavy = equation.inertia / h
    push = (heavy - 0.5 * found.drag) * v + found.slope * ahead
    push = push + drive - equation.compute_rigid(q) - found.held - found.bristle
    w = np.sign(push) * np.maximum(np.abs(push) - found.dry, 0.0) / (heavy + 0.5 * found.drag + found.slope)
    if state.memory:
        at = equation.compute_point(q, w, state.acceleration, channels)
        state.memory = advance_states(equation.law, at, state.memory, h)
    state.acceleration = (w - v) / h
    state.position = state.position + 0.5 * h * (v + w)
    state.velocity = w


def count_substeps(law: FrictionLaw, inertia: float, dt: float, top: float) -> int:
    """Steps of a sample: fine enough for every oscillation of the model, within reason.

    Args:
        law: Friction.
        inertia: That it acts on [kg·m²] or [kg].
        dt: Time between samples [s].
        top: Speed of the motion [rad/s] or [m/s].
    """
    rates = [EVALUATION.angle / EVALUATION.longest_step]
    for term in law.terms:
        if isinstance(term, LuGre | Dahl):
            rates.append((term.sigma_0 / inertia) ** 0.5)
        if isinstance(term, SpringTorque | EndStop):
            rates.append((term.stiffness / inertia) ** 0.5)
        order = getattr(term, "order", None)
        if order is not None:
            rates.append(order * top)
    return int(min(max(np.ceil(max(rates) * dt / EVALUATION.angle), 1), EVALUATION.most_substeps))
