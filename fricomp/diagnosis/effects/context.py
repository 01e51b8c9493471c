"""The motion that effects are computed from: that of the fitted base model, not of the noisy encoder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.signal import savgol_filter

from fricomp.root_mean_square import compute_rms

from ..inputs.past import Past
from ..inputs.track import FloatArray, Track, differentiate
from ..joint.observer import Observation, Observer, Plant
from ..joint.problem import Problem
from .settings import EFFECT

__all__ = ["Context", "add_load", "build_contexts", "move_context"]


@dataclass(frozen=True)
class Context:
    """What effects may draw on along one recording: the motion of the fitted base model, and recorded channels.

    Attributes:
        dt: Sample time [s].
        position: Position [rad] or [m]. Shape (n,), like all arrays here.
        velocity: Velocity of the model [rad/s] or [m/s]; exactly smooth at rest.
        acceleration: Acceleration [rad/s²] or [m/s²].
        torque: Torque that the base model needs: that of the recording without its noise [N·m] or [N].
        recorded: Torque of the recording [N·m] or [N]. What follows it explains its noise as well.
        gravity: Gravity torque of the base model [N·m] or [N].
        load_torque: Torque transmitted to the load: recorded, else gravity of the base model [N·m].
        friction: Friction torque of the base model [N·m].
        plant: The base model.
        rotary: Whether positions are angles.
        channels: Further recorded columns by name.
        scale: Typical friction torque, for scaling parameters [N·m].
        usual_load: Typical load [N·m], the same in all recordings and whatever is fitted.
        usual_temperature: Mean temperature of all recordings [°C]; 0 where it was not recorded.
        noise: Standard deviation of the noise in the recorded torque [N·m] or [N].
        index: Which of the tracks this is, counted from 0.
        source: Which of the recordings it is a part of, counted from 0.
        past: How the joint was driven over all of that recording; None where this is all of it.
        hints: Starting values found in the residual, such as the orders over position that stand out.
        usual_delay: By how much the torque is late without any flaw, and how far that strays [s].
        delays: Earliest and latest that a torque without any flaw comes [s].
        acts_late: Time by which the recorded torque was moved, since it acts so long after its stamp [s].
        row_width: Width of the windows of the residual [s]; what is much faster does not show.
    """

    dt: float
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    recorded: FloatArray
    gravity: FloatArray
    load_torque: FloatArray
    friction: FloatArray
    plant: Plant
    rotary: bool
    scale: float
    usual_load: float = 1.0
    usual_temperature: float = 0.0
    channels: Mapping[str, FloatArray] = field(default_factory=dict)
    noise: float = 0.0
    index: int = 0
    source: int = 0
    past: Past | None = None
    hints: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    usual_delay: tuple[float, float] = (0.0, 2.5e-4)
    delays: tuple[float, float] = (-5e-4, 5e-4)
    acts_late: float = 0.0
    row_width: float = Observer().row_width

    @property
    def time(self) -> FloatArray:
        """Time since the first sample [s]."""
        return np.arange(self.position.size, dtype=np.float64) * np.float64(self.dt)

    @cached_property
    def waves(self) -> tuple[FloatArray, FloatArray]:
        """Cosine and sine of the position. Shapes (n,)."""
        return np.cos(self.position), np.sin(self.position)

    @cached_property
    def quick_velocity(self) -> FloatArray:
        """Velocity of the position, smoothed no longer than a contact lasts [rad/s]. Shape (n,)."""
        return differentiate(self.position, self.dt, EFFECT.quick_window)

    @cached_property
    def quick_acceleration(self) -> FloatArray:
        """Acceleration of the position, smoothed no longer than a contact lasts [rad/s²]. Shape (n,)."""
        return differentiate(self.quick_velocity, self.dt, EFFECT.quick_window)

    @property
    def stribeck_velocity(self) -> FloatArray:
        """Stribeck velocity of the direction of motion [rad/s]."""
        return np.where(self.velocity >= 0.0, self.plant.forward[2], self.plant.reverse[2])


def build_contexts(
    problem: Problem, plant: Plant, observations: Sequence[Observation], hints: Mapping[str, tuple[float, ...]]
) -> list[Context]:
    """One context for each recording."""
    temperatures = [track.channels.get("temperature", np.zeros(1)) for track in problem.tracks]
    usual = float(np.mean([np.mean(one) for one in temperatures]))
    return [
        replace(
            _build_context(track, plant, one, hints),
            index=i,
            source=track.source,
            past=track.past,
            usual_temperature=usual,
            row_width=problem.observer.row_width,
        )
        for i, (track, one) in enumerate(zip(problem.tracks, observations, strict=True))
    ]


def _build_context(track: Track, plant: Plant, seen: Observation, hints: Mapping[str, tuple[float, ...]]) -> Context:
    position = _correct_position(track, seen)
    # From the encoder alone, and smooth: the model's own acceleration answers to the noise of the torque, and columns
    # made from it would explain that noise.
    velocity = differentiate(track.position, track.dt, EFFECT.smooth_window)
    acceleration = differentiate(velocity, track.dt, EFFECT.smooth_window)
    load = track.channels.get("load_torque")
    gravity = plant.compute_gravity_torque(position, track.rotary)
    load = gravity - plant.offset if load is None else remove_noise(load, position, acceleration, track)
    v = seen.velocity
    viscous = np.where(v >= 0.0, plant.forward[3], plant.reverse[3]) * v
    return Context(
        dt=track.dt,
        position=position,
        velocity=v,
        acceleration=acceleration,
        torque=gravity + plant.inertia * acceleration + smooth(seen.bristle, track.dt) + viscous,
        recorded=track.torque,
        noise=track.torque_noise.size,
        gravity=gravity - plant.offset,
        load_torque=load,
        friction=seen.bristle + viscous,
        plant=plant,
        rotary=track.rotary,
        scale=max(plant.level, compute_rms(seen.bristle + viscous), EFFECT.still_scale * float(np.std(track.torque))),
        usual_load=max(float(np.hypot(*plant.gravity)), plant.level),
        channels=track.channels,
        hints=hints,
        usual_delay=track.usual_delay,
        delays=track.delays,
        acts_late=track.acts_late,
    )


def _correct_position(track: Track, seen: Observation) -> FloatArray:
    """Move the model's position to the recorded one as far as the encoder contradicts it. Shape (n,).

    What changes fast within a step of the encoder is its rounding: a load that swings on a spring would answer to it
    by more than the noise of the torque.
    """
    off = track.position - seen.position
    slow = smooth(off, track.dt)
    quick, step = off - slow, track.resolution
    beyond = quick - np.clip(quick, -step, step)
    return np.asarray(seen.position + slow + smooth(beyond, track.dt, EFFECT.quick_window), dtype=np.float64)


def move_context(context: Context, track: Track, seen: Observation) -> Context:
    """Take the position of another joint that was held to the same recording."""
    return replace(context, position=_correct_position(track, seen))


def add_load(context: Context, plant: Plant, further: FloatArray) -> Context:
    """Take the load of another plant on the same motion, and a further one [N·m]. A recorded load stays. Shape (n,)."""
    gravity = plant.compute_gravity_torque(context.position, context.rotary) - plant.offset + further
    recorded = "load_torque" in context.channels
    return replace(context, gravity=gravity, load_torque=context.load_torque if recorded else gravity)


def smooth(values: FloatArray, dt: float, over: float = EFFECT.smooth_window) -> FloatArray:
    """Local cubic over a window of this length [s]. Shape (n,)."""
    window = max(EFFECT.smooth_rows, 2 * round(over / dt / 2) + 1)
    result: FloatArray = savgol_filter(values, window, 3)
    return result


def remove_noise(load: FloatArray, position: FloatArray, acceleration: FloatArray, track: Track) -> FloatArray:
    """Remove the noise of a recorded load, which may be the noise of the torque as well [N·m]. Shape (n,).

    Where gravity and acceleration explain the load it is replaced by what they explain, else it is smoothed.
    """
    columns = [np.ones_like(position), acceleration]
    columns += [np.cos(position), np.sin(position)] if track.rotary else []
    A = np.stack(columns, axis=1)
    explained: FloatArray = A @ np.linalg.lstsq(A, load, rcond=None)[0]
    calm = smooth(load, track.dt)
    return explained if float(np.var(calm - explained)) < EFFECT.unexplained_load * float(np.var(calm)) else calm
