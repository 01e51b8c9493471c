"""The motion that effects are computed from: that of the fitted base model, not of the noisy encoder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import savgol_filter

from ..inputs.track import FloatArray, Track, differentiate
from ..joint.observer import Observation, Plant
from ..joint.problem import Problem
from . import Context
from .settings import EFFECT

__all__ = ["add_load", "build_contexts", "move_context"]


def build_contexts(
    problem: Problem, plant: Plant, observations: Sequence[Observation], hints: Mapping[str, tuple[float, ...]]
) -> list[Context]:
    """One context for each recording."""
    temperatures = [track.channels.get("temperature", np.zeros(1)) for track in problem.tracks]
    usual = float(np.mean([np.mean(one) for one in temperatures]))
    return [
        replace(_build_context(track, plant, one, hints), index=i, usual_temperature=usual)
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
        scale=max(0.5 * (plant.forward[0] + plant.reverse[0]), 0.02 * float(np.std(track.torque))),
        usual_load=max(float(np.hypot(*plant.gravity)), plant.level),
        channels=track.channels,
        hints=hints,
        usual_delay=track.usual_delay,
    )


def _correct_position(track: Track, seen: Observation) -> FloatArray:
    """The model's position, moved to the recorded one as far as the encoder contradicts it. Shape (n,).

    What changes fast within a step of the encoder is its rounding: a load that swings on a spring would answer to it
    by more than the noise of the torque.
    """
    off = track.position - seen.position
    slow = smooth(off, track.dt)
    quick, step = off - slow, track.resolution
    beyond = quick - np.clip(quick, -step, step)
    return np.asarray(seen.position + slow + smooth(beyond, track.dt, EFFECT.quick_window), dtype=np.float64)


def move_context(context: Context, track: Track, seen: Observation) -> Context:
    """The same recording with the position of another joint that was held to it."""
    return replace(context, position=_correct_position(track, seen))


def add_load(context: Context, plant: Plant, further: FloatArray) -> Context:
    """The same motion of another plant, which carries a further load [N·m]; a recorded load stays. Shape (n,)."""
    gravity = plant.compute_gravity_torque(context.position, context.rotary) - plant.offset + further
    recorded = "load_torque" in context.channels
    return replace(context, plant=plant, gravity=gravity, load_torque=context.load_torque if recorded else gravity)


def smooth(values: FloatArray, dt: float, over: float = EFFECT.smooth_window) -> FloatArray:
    """Local cubic over a window of this length [s]. Shape (n,)."""
    window = max(7, 2 * round(over / dt / 2) + 1)
    result: FloatArray = savgol_filter(values, window, 3)
    return result


def remove_noise(load: FloatArray, position: FloatArray, acceleration: FloatArray, track: Track) -> FloatArray:
    """A recorded load without its noise, which may be the noise of the torque as well [N·m]. Shape (n,).

    Where gravity and acceleration explain the load it is replaced by what they explain, else it is smoothed.
    """
    columns = [np.ones_like(position), acceleration]
    columns += [np.cos(position), np.sin(position)] if track.rotary else []
    A = np.stack(columns, axis=1)
    explained: FloatArray = A @ np.linalg.lstsq(A, load, rcond=None)[0]
    calm = smooth(load, track.dt)
    return explained if float(np.var(calm - explained)) < EFFECT.unexplained_load * float(np.var(calm)) else calm
