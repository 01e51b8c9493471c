"""Forward simulation in MuJoCo under the recorded reference: does the joint move as recorded, before and after?

One joint with the refitted inertia, gravity and friction, moved by the loop that moved the real one. Dry friction is
MuJoCo's own friction loss, its level set in every step; what effects add is taken along the recorded motion. The
parameters come from the samples before the stretch that is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, exp, sin
from typing import Any

import numpy as np

from fricomp.errors import MissingExtraError
from fricomp.recording import Recording

from .controller import Controller
from .explanation import Explanation
from .observer import Contribution, Plant
from .preparation import Prepared
from .result import Forward
from .solver import Box, at_least
from .structure import N_BASE, Structure
from .track import SIMULATED_SPRING, FloatArray, Track

__all__ = ["Run", "forward_error", "simulate_forward", "with_spring"]

_HELD_OUT = 1.0 / 3.0  # of the recording, its last part
_LONGEST = 20.0  # [s]
_GAP = 0.5  # [s] between the rows that are fitted and the stretch
_STEP = 5e-4  # [s] longest step of the simulation
_SETTLE = 0.1  # of the stretch, in which the initial state dies out
_XML = """<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicitfast"/><worldbody><body>
<inertial pos="0 0 0" mass="1e-9" diaginertia="1e-12 1e-12 1e-12"/>
<joint name="joint" type="{kind}" axis="0 0 1" armature="{inertia}" frictionloss="1e-9"
 solreffriction="{stiff} 1" solimpfriction="0.99 0.999 1e-6"/>
</body></worldbody></mujoco>"""


@dataclass(frozen=True)
class Run:
    """What a forward simulation needs.

    Attributes:
        plant: The joint.
        added: What its effects add along the recorded motion.
        track: The recorded motion.
        reference: Position and velocity that the loop is told [rad, rad/s]. Shape (2, n).
        controller: The loop.
        start: First sample.
        stop: Sample behind the last one.
    """

    plant: Plant
    added: Contribution
    track: Track
    reference: FloatArray
    controller: Controller
    start: int
    stop: int


def forward_error(
    recording: Recording, prepared: Prepared, chosen: Explanation | None, controller: Controller
) -> Forward | None:
    """Position errors of the base and of the extended model on the last part of the first recording.

    Returns:
        None where no reference was recorded, or the simulation leaves the recorded motion.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    track = prepared.problem.tracks[0]
    if recording.position_reference is None:
        return None
    length = min(_HELD_OUT * track.size * track.dt, _LONGEST)
    start = track.size - round(length / track.dt)
    base = _trained(prepared, (prepared.structure, prepared.fit.theta, prepared.fit.jacobian), start)
    runs = [_run(recording, prepared, (prepared.structure, base), controller, start)]
    if chosen is not None:
        theta = _trained(prepared, (chosen.structure, chosen.fit.theta, chosen.fit.jacobian), start)
        runs.append(_run(recording, prepared, (chosen.structure, theta), controller, start))
    kept = slice(start + round(_SETTLE * (track.size - start)), track.size)
    errors = [_rms(simulate_forward(run)[kept.start - start :] - track.position[kept]) for run in runs]
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


def _run(
    recording: Recording,
    prepared: Prepared,
    model: tuple[Structure, FloatArray],
    controller: Controller,
    start: int,
) -> Run:
    structure, theta = model
    track, added = with_spring(prepared.problem.tracks[0], structure.contributions(theta[N_BASE:])[0])
    plant = replace(structure.plant(theta), **added.plant)
    time = np.asarray(recording.time) - recording.time[0]
    position = np.interp(track.time, time, np.asarray(recording.position_reference))
    told = recording.velocity_reference
    velocity = np.gradient(position, track.dt) if told is None else np.interp(track.time, time, np.asarray(told))
    return Run(plant, added, track, np.stack([position, velocity]), controller, start, track.size)


def with_spring(track: Track, added: Contribution) -> tuple[Track, Contribution]:
    """Recording and effects with the spring of the simulation, which the torque of a track is without."""
    spring = track.channels.get(SIMULATED_SPRING)
    if spring is None:
        return track, added
    return replace(track, torque=track.torque + spring), replace(added, additive=added.additive + spring)


def _trained(prepared: Prepared, model: tuple[Structure, FloatArray, FloatArray], start: int) -> FloatArray:
    """Parameters from the rows before `start` of the first recording and all of the others: one step from the fit."""
    structure, theta, jacobian = model
    residual = structure.residuals(prepared.problem, [theta])[0]
    first = prepared.problem.grids[0].centres
    kept = np.ones(residual.size, dtype=bool)
    kept[: first.size] = first < start - _GAP / prepared.problem.tracks[0].dt
    box: Box = prepared.box.joined(structure.box())
    A = jacobian[kept] * box.scale
    prior = at_least(box.scaled_precision, 0.1)
    step = np.linalg.solve(A.T @ A + prior, -A.T @ residual[kept])
    return box.clip(theta + box.scale * np.clip(step, -1.0, 1.0))


def simulate_forward(run: Run) -> FloatArray:
    """Position of the simulated joint at the samples of the stretch [rad] or [m]. Shape (stop - start,)."""
    try:
        import mujoco
    except ImportError as error:
        raise MissingExtraError("mujoco", "diagnose") from error
    track, plant = run.track, run.plant
    substeps = max(1, int(np.ceil(track.dt / _STEP)))
    step = track.dt / substeps
    kind = "hinge" if track.rotary else "slide"
    text = _XML.format(step=step, kind=kind, inertia=plant.inertia, stiff=2.5 * step)
    model: Any = mujoco.MjModel.from_xml_string(text)
    data: Any = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = track.position[run.start], track.velocity[run.start]
    # Single numbers come from lists at a fraction of what an array takes to give them, tens of thousands of times.
    level, additive = (
        np.broadcast_to(np.asarray(one), (track.size,)).tolist() for one in (run.added.level, run.added.additive)
    )
    loop, drive = _Loop(run, step), _Drive(run, step)
    position, velocity, friction, applied = data.qpos, data.qvel, model.dof_frictionloss, data.qfrc_applied
    out = np.empty(run.stop - run.start)
    for k in range(run.start, run.stop):
        out[k - run.start] = position[0]
        for _ in range(substeps):
            q, w = position.item(), velocity.item()
            dry, viscous = _friction(plant, w)
            friction[0] = max(dry + level[k], 1e-9)
            acting = drive.follow(loop.torque(k, q, w)) - _gravity(plant, q, track.rotary)
            applied[0] = acting - viscous - additive[k]
            mujoco.mj_step(model, data)
    return out


class _Loop:
    """The controller with its state: the filtered velocity and the integral."""

    def __init__(self, run: Run, step: float) -> None:
        self.run, self.step, self.integral = run, step, 0.0
        self.keep = run.controller.filtered(step)
        self.seen = float(run.track.velocity[run.start])
        self.wanted: list[float] = run.reference[0].tolist()
        self.speed: list[float] = run.reference[1].tolist()
        self.acceleration: list[float] = np.gradient(run.reference[1], run.track.dt).tolist()
        if run.controller.integral_gain:
            start = float(run.track.torque[run.start])
            rest = start - self.torque(run.start, float(run.track.position[run.start]), self.seen)
            self.integral = rest / run.controller.integral_gain

    def torque(self, k: int, q: float, w: float) -> float:
        """Torque at sample `k` for the simulated position and velocity [N·m]."""
        c = self.run.controller
        self.seen = w + (self.seen - w) * self.keep
        error = self.wanted[k] - q
        self.integral += error * self.step
        damping = c.derivative_gain * (c.reference_share * self.speed[k] - self.seen)
        steady = c.proportional_gain * error + c.integral_gain * self.integral + c.bias
        total = steady + damping + c.acceleration_gain * self.acceleration[k]
        limit = c.torque_limit
        return total if limit is None else min(max(total, -limit), limit)


class _Drive:
    """What the drive makes of its command: the low passes that were named, with their states."""

    def __init__(self, run: Run, step: float) -> None:
        self.keep = [float(np.exp(-step / lag)) for lag in run.added.lags]
        self.states = [float(run.track.torque[run.start])] * len(self.keep)

    def follow(self, torque: float) -> float:
        """Torque that acts a step later [N·m]."""
        for i, keep in enumerate(self.keep):
            torque = self.states[i] = torque + (self.states[i] - torque) * keep
        return torque


def _friction(plant: Plant, w: float) -> tuple[float, float]:
    """Level of dry friction and viscous torque at velocity `w` [N·m]."""
    coulomb, static, speed, viscous = plant.forward if w >= 0.0 else plant.reverse
    fall = exp(-min(abs(w / speed) ** plant.stribeck_exponent, 50.0))
    return coulomb + (static - coulomb) * fall, viscous * w


def _gravity(plant: Plant, q: float, rotary: bool) -> float:
    if not rotary:
        return plant.offset
    return plant.gravity[0] * cos(q) + plant.gravity[1] * sin(q) + plant.offset


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
