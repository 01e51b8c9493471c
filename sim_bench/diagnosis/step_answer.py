"""What a loop makes of the encoder's steps: real torque, which moves the joint, unlike noise of the torque's sensor."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .controller import Controller
from .kernel import LANES, close_loop
from .observer import THREADS, Contribution, Job, Observation, Plant, lanes_of, shifted
from .track import FloatArray, Track

__all__ = ["StepAnswer", "step_answers"]

_LOUD = 0.5  # of the noise seen in the torque, below which the answer is not worth a simulation
_ASTRAY = 10.0  # steps of the encoder that the joint may be off, else it is no loop that moved a joint


class StepAnswer(NamedTuple):
    """One joint under a loop that sees its position in steps.

    Attributes:
        position: As the encoder shows it [rad]. Shape (n,).
        torque: What the loop adds because of the steps [N·m]. Shape (n,).
    """

    position: FloatArray
    torque: FloatArray


def step_answers(
    track: Track,
    plant: Plant,
    effect: Contribution,
    truth: Observation,
    applied: FloatArray,
    *,
    count: int,
    seed: int,
) -> list[StepAnswer]:
    """Simulate the loop of a recording `count` times, each time with another origin of the encoder.

    Args:
        track: The recording.
        plant: The joint.
        effect: What effects add to it.
        truth: Its motion without the steps.
        applied: Torque that moves it so, as late as the recorded one [N·m]. Shape (n,).
        count: Number of simulations.
        seed: Of the origins.

    Returns:
        Nothing where no loop is known or its answer is lost in the noise of the torque.
    """
    loop = track.loop
    if loop is None or loop.derivative_gain <= 0.0 or track.resolution <= 0.0:
        return []
    phases = np.random.default_rng([seed, count]).uniform(size=count)
    told = replace(track, position=truth.position, velocity=truth.velocity, torque=applied)
    batches = [phases[i : i + LANES] for i in range(0, count, LANES)]
    with ThreadPoolExecutor(THREADS) as pool:
        first = _run(Job(told, plant, effect), loop, batches[0])
        if not _credible(first[0], truth, track):
            return []
        runs = [first, *pool.map(lambda batch: _run(Job(told, plant, effect), loop, batch), batches[1:])]
    # The answer is held for a sample; the torque of a recording runs straight from sample to sample.
    late = -0.5 - plant.delay / track.dt
    return [StepAnswer(seen, shifted(torque, late)) for run in runs for seen, torque in run]


def _run(job: Job, loop: Controller, phases: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Positions that at most `LANES` encoders show, and the torque of their loops."""
    track, (signals, plants) = job.track, lanes_of([job])
    frequency = loop.velocity_filter_frequency
    kept = 0.0 if frequency is None else float(np.exp(-2.0 * np.pi * frequency * track.dt))
    gains = np.array([track.dt, loop.proportional_gain, loop.derivative_gain, kept, track.resolution])
    origins, out = np.resize(phases, LANES), np.empty((2, LANES, track.size))
    close_loop(signals[0], signals[1], signals[2], signals[3], plants, gains, origins, track.substeps, out)
    return [(out[1, lane], out[0, lane]) for lane in range(phases.size)]


def _credible(run: tuple[FloatArray, FloatArray], truth: Observation, track: Track) -> bool:
    """Whether the answer stands out of the torque's noise and leaves the joint where it was."""
    seen, torque = run
    near = bool(np.std(seen - truth.position) < _ASTRAY * track.resolution)
    return near and float(np.std(torque)) > _LOUD * track.torque_noise.size
