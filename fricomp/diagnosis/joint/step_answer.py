"""What a loop makes of the encoder's steps: real torque, which moves the joint, unlike noise of the torque's sensor."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..inputs.controller import Controller
from ..inputs.delay import shift
from ..inputs.track import FloatArray, Track
from .kernel import LANES, close_loop
from .observer import Job, Observation, broadcast_level, choose_lanes, compute_torque, stack_plants
from .settings import JOINT
from .threads import run_in_threads


class StepAnswer(NamedTuple):
    """One joint under a loop that sees its position in steps.

    Attributes:
        position: Position as the encoder shows it [rad]. Shape (n,).
        torque: What the loop adds because of the steps [N·m]. Shape (n,).
    """

    position: FloatArray
    torque: FloatArray


def simulate_step_answers(
    job: Job, truth: Observation, applied: FloatArray, *, count: int, seed: int
) -> list[StepAnswer]:
    """Simulate the loop of a recording `count` times, each time with another origin of the encoder.

    What the steps change is taken from a simulation without them, and added to the motion: a resting joint is held to
    its recording, which the simulation of a loop is not.

    Args:
        job: The recording, the joint, and what effects add to it.
        truth: Motion of the joint without the steps.
        applied: Torque that moves it so, as late as the recorded one [N·m]. Shape (n,).
        count: Number of simulations.
        seed: Seed of the origins.

    Returns:
        Nothing where no loop is known or its answer is lost in the noise of the torque.
    """
    track, loop = job.track, job.track.loop
    if loop is None or loop.derivative_gain <= 0.0 or track.resolution <= 0.0:
        return []
    told = job._replace(track=replace(track, position=truth.position, velocity=truth.velocity, torque=applied))
    steps = np.array([0.0, *np.full(count, track.resolution)])
    encoders = np.stack([steps, steps * np.random.default_rng(seed).uniform(size=count + 1)])
    batches = [encoders[:, i : i + LANES[-1]] for i in range(0, count + 1, LANES[-1])]
    first = _run(told, loop, batches[0])
    smooth, stepped = first[0], first[1]
    if not _is_credible(stepped, smooth, truth, track):
        return []
    further = run_in_threads(lambda one: _run(told, loop, one), batches[1:])
    runs = [*first[1:], *(run for batch in further for run in batch)]
    # The answer is held for a sample; the torque of a recording runs straight from sample to sample.
    late = -0.5 - job.plant.delay / track.dt
    return [
        StepAnswer(truth.position + run.position - smooth.position, shift(run.torque - smooth.torque, late))
        for run in runs
    ]


def _run(job: Job, loop: Controller, encoders: FloatArray) -> list[StepAnswer]:
    """Joints under the loop, each with its encoder, no more than the kernel has lanes."""
    track, lanes = job.track, choose_lanes(encoders.shape[1])
    signals = np.stack([track.position, track.velocity, compute_torque(job), broadcast_level(job)])
    settings = (track.dt, loop.proportional_gain, loop.derivative_gain, loop.compute_filter_memory(track.dt))
    each, out = np.resize(encoders.T, (len(lanes), 2)).T.copy(), np.empty((2, len(lanes), track.size))
    close_loop(signals, stack_plants([job], lanes), settings, each, track.substeps, lanes, out)
    return [StepAnswer(out[1, lane], out[0, lane]) for lane in range(encoders.shape[1])]


def _is_credible(stepped: StepAnswer, smooth: StepAnswer, truth: Observation, track: Track) -> bool:
    """Whether the loop leaves the joint where it was, and its answer stands out of the torque's noise."""
    with np.errstate(over="ignore", invalid="ignore"):  # a loop that swings up
        far = max(float(np.std(one.position - truth.position)) for one in (stepped, smooth))
        loud = float(np.std(stepped.torque - smooth.torque)) > JOINT.heard_share * track.torque_noise.size
    return far < JOINT.astray_steps * track.resolution and loud
