"""Forward simulation in MuJoCo under the recorded reference: does the joint move as recorded, before and after?

One joint with the refitted inertia, gravity and friction, moved by the loop that moved the real one. What effects
remember, and a load behind a spring or a gap, follow the simulated motion (`ForwardPart`); what else effects add is
taken along the recorded one. The parameters come from the samples before the stretch that is simulated.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..effects.forward_part import ForwardPart
from ..effects.structure import N_BASE, Structure
from ..inputs.controller import Controller
from ..inputs.track import SIMULATED_SPRING, FloatArray, Track
from ..joint.observer import Contribution
from ..joint.solver import Box, raise_diagonal
from ..record.result import Forward
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from .forward_joint import Run, simulate_forward
from .settings import FORWARD


def measure_forward_error(
    recording: Recording, baseline: Baseline, chosen: Explanation | None, controller: Controller
) -> Forward | None:
    """Measure the position errors of the base and of the extended model on the last part of the first recording.

    Returns:
        None where no reference was recorded, or the simulation leaves the recorded motion.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    track = baseline.problem.tracks[0]
    if recording.position_reference is None:
        return None
    length = min(FORWARD.held_out * track.size * track.dt, FORWARD.longest)
    start = track.size - round(length / track.dt)
    loop = _set_rate(controller, recording, track)
    base = _train(baseline, (baseline.structure, baseline.fit.theta, baseline.fit.jacobian), start)
    runs = [_build_run(recording, baseline, (baseline.structure, base), loop, start)]
    if chosen is not None:
        theta = _train(baseline, (chosen.structure, chosen.fit.theta, chosen.fit.jacobian), start)
        runs.append(_build_run(recording, baseline, (chosen.structure, theta), loop, start))
    kept = slice(start + round(FORWARD.settling * (track.size - start)), track.size)
    errors = [compute_rms(simulate_forward(run)[kept.start - start :] - track.position[kept]) for run in runs]
    if not all(np.isfinite(errors)) or errors[0] > float(np.ptp(track.position)):
        return None
    metadata = recording.metadata
    return Forward(
        rmse_before=errors[0],
        rmse_after=errors[-1],
        unit=metadata.position_unit,
        controller=controller.describe(metadata.torque_unit, metadata.position_unit),
        interval=(float(track.time[kept.start]), float(track.time[-1])),
    )


def _set_rate(controller: Controller, recording: Recording, track: Track) -> Controller:
    """Give the loop a rate: that of the recording where none is known, unless that is too slow to be the loop's."""
    slow = recording.sample_period > FORWARD.slow_sampling * track.dt
    return controller if controller.frequency or slow else replace(controller, frequency=1.0 / recording.sample_period)


def _build_run(
    recording: Recording,
    baseline: Baseline,
    model: tuple[Structure, FloatArray],
    controller: Controller,
    start: int,
) -> Run:
    structure, theta = model
    track, effects = add_spring(baseline.problem.tracks[0], _collect_effects(structure, theta))
    plant = replace(structure.unpack_plant(theta), **effects.along.plant)
    time = np.asarray(recording.time) - recording.time[0]
    position = np.interp(track.time, time, np.asarray(recording.position_reference))
    told = recording.velocity_reference
    velocity = np.gradient(position, track.dt) if told is None else np.interp(track.time, time, np.asarray(told))
    return Run(plant, track, np.stack([position, velocity]), controller, start, track.size, effects)


def _collect_effects(structure: Structure, theta: FloatArray) -> ForwardPart:
    """What the effects are along the first recording."""
    values, context = structure.name_values(theta[N_BASE:]), structure.contexts[0]
    parts = [one.effect.build_forward_part(context, values[one.name]) for one in structure.candidates]
    return sum(parts, ForwardPart())


def add_spring(track: Track, effects: ForwardPart) -> tuple[Track, ForwardPart]:
    """Recording and effects with the spring of the simulation, which the torque of a track is without."""
    spring = track.channels.get(SIMULATED_SPRING)
    if spring is None:
        return track, effects
    return replace(track, torque=track.torque + spring), effects + ForwardPart(Contribution(additive=spring))


def _train(baseline: Baseline, model: tuple[Structure, FloatArray, FloatArray], start: int) -> FloatArray:
    """Fit the parameters to the rows before `start` of the first recording and to all of the others, by one step from
    the fit."""
    structure, theta, jacobian = model
    residual = structure.compute_residuals(baseline.problem, [theta])[0]
    first = baseline.problem.grids[0].centres
    kept = np.ones(residual.size, dtype=bool)
    kept[: first.size] = first < start - FORWARD.gap / baseline.problem.tracks[0].dt
    box: Box = baseline.box.join(structure.build_box())
    A = jacobian[kept] * box.scale
    prior = raise_diagonal(box.scaled_precision, 0.1)
    step = np.linalg.solve(A.T @ A + prior, -A.T @ residual[kept])
    return box.clip(theta + box.scale * np.clip(step, -1.0, 1.0))
