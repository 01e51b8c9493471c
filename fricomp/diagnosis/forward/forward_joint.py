"""One joint in MuJoCo, moved by its loop: motor side and load as two bodies where a spring or a gap parts them.

MuJoCo has the bodies, their inertia, the damping of the spring and friction loss. Applied in every step are the loop's
torque, gravity, the spring outside of its gap, friction that gives way or creeps, and what effects add along the
recorded motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import copysign, cos, sin
from typing import Any

import numpy as np

from fricomp.errors import MissingExtraError
from fricomp.mujoco_warnings import silence_mujoco

from ..effects.forward_part import ForwardPart
from ..effects.two_masses import Coupling
from ..inputs.controller import Controller
from ..inputs.track import FloatArray, Track
from ..joint.observer import Plant
from .dry_friction import FrictionCurve, build_dry_friction, compute_bristle_rate
from .forward_loop import Drive, Loop
from .settings import FORWARD

_XML = """<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicitfast"/><worldbody><body>
<inertial pos="0 0 0" mass="1e-9" diaginertia="1e-12 1e-12 1e-12"/>
<joint type="{kind}" axis="0 0 1" armature="{motor}" frictionloss="1e-9"
 solreffriction="{stiff} 1" solimpfriction="0.99 0.999 1e-6"/>{load}</body></worldbody></mujoco>"""
_LOAD = """<body><inertial pos="0 0 0" mass="{0}" diaginertia="{0} {0} {0}"/><joint type="{1}" axis="0 0 1"/></body>"""


@dataclass(frozen=True)
class Run:
    """What a forward simulation needs.

    Attributes:
        plant: The joint.
        track: The recorded motion.
        reference: Position and velocity that the loop is told [rad, rad/s]. Shape (2, n).
        controller: The loop; without a frequency it answers in every step.
        start: First sample.
        stop: Sample behind the last one.
        effects: What the joint has beside that.
    """

    plant: Plant
    track: Track
    reference: FloatArray
    controller: Controller
    start: int
    stop: int
    effects: ForwardPart = field(default_factory=ForwardPart)

    @property
    def motor(self) -> float:
        """Inertia of the motor side [kg·m²]."""
        load = 0.0 if self.effects.coupling is None else self.effects.coupling.inertia
        return max(self.plant.inertia - load, FORWARD.least_motor_share * self.plant.inertia)

    @property
    def substeps(self) -> int:
        """Steps of a sample: fine enough for the loop, the load on its spring, and a bristle unless none would be; of
        such numbers the first that is a whole one for each answer of the loop, or comes closest.
        """
        rates = [] if self.effects.coupling is None else [self.effects.coupling.compute_rate(self.motor)]
        bristle = compute_bristle_rate(self.plant, self.motor)
        rates += [bristle] if bristle * FORWARD.shortest_step <= FORWARD.soft_bristle else []
        frequency, most = self.controller.frequency, self.track.dt / FORWARD.shortest_step
        wanted = max([1.0 / FORWARD.longest_step, frequency or 0.0, *(rate / FORWARD.fine for rate in rates)])
        least = int(np.ceil(min(self.track.dt * wanted, most)))
        if frequency is None:
            return least
        answers = self.track.dt * frequency
        return min(range(least, max(least, int(most)) + 1), key=lambda n: (_measure_remainder(n / answers), n))


def _measure_remainder(steps: float) -> float:
    """How far steps for each answer of the loop are from a whole number of them, to a millionth."""
    return round(abs(steps - max(round(steps), 1)), 6)


def simulate_forward(run: Run) -> FloatArray:
    """Position of the simulated joint at the samples of the stretch [rad] or [m]. Shape (stop - start,).

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    try:
        import mujoco
    except ImportError as error:
        raise MissingExtraError("mujoco", "diagnose") from error
    substeps = run.substeps
    step = run.track.dt / substeps
    model: Any = mujoco.MjModel.from_xml_string(_write_model(run, step))
    data: Any = mujoco.MjData(model)
    joint = _Joint(run, model, data, step)
    out = np.empty(run.stop - run.start)
    with silence_mujoco():
        for k in range(run.start, run.stop):
            out[k - run.start] = data.qpos[0]
            for _ in range(substeps):
                joint.push(k)
                mujoco.mj_step(model, data)
    return out


def _write_model(run: Run, step: float) -> str:
    kind = "hinge" if run.track.rotary else "slide"
    coupling = run.effects.coupling
    load = "" if coupling is None else _LOAD.format(coupling.inertia, kind)
    return _XML.format(step=step, kind=kind, motor=run.motor, stiff=2.5 * step, load=load)


class _Joint:
    """What acts on the simulated joint, with all that it remembers."""

    def __init__(self, run: Run, model: Any, data: Any, step: float) -> None:
        track, k, along = run.track, run.start, run.effects.along
        # Single numbers come from lists at a fraction of what an array takes to give them, tens of thousands of times.
        self.level, self.additive = (
            np.broadcast_to(np.asarray(one), (track.size,)).tolist() for one in (along.level, along.additive)
        )
        self.q, self.w, self.applied, self.loss = data.qpos, data.qvel, data.qfrc_applied, model.dof_frictionloss
        self.q[0], self.w[0] = q, w = float(track.position[k]), float(track.velocity[k])
        torque = float(track.torque[k])
        self.loop = Loop(run.controller, track, run.reference, k, step)
        self.drive, self.lagging = Drive(along.lags, torque, step), bool(along.lags)
        self.curve = FrictionCurve(run.plant, step, w)
        self.states, self.friction = run.effects.states, 0.0
        for state in self.states:
            state.begin(k, step)
        gravity = _Gravity(run.plant, track.rotary)
        coupling = run.effects.coupling
        self.load = _Rigid(gravity) if coupling is None else _Coupled(gravity, coupling, model, data)
        self.offset = run.plant.offset
        level, viscous = self.curve.follow(w)
        level = max(level + self.level[k], FORWARD.least_level)
        held = torque - self.offset - self.additive[k] - viscous - gravity.compute_torque(q)
        self.dry = build_dry_friction(run.plant, run.motor, step, min(max(held, -level), level))

    def push(self, k: int) -> None:
        """Set the torques of the next step, in sample `k`."""
        q, w = self.q.item(0), self.w.item(0)
        level, viscous = self.curve.follow(w)
        level += self.level[k]
        command = self.loop.compute_torque(k, q)
        net = (self.drive.follow(command) if self.lagging else command) - self.offset - viscous - self.additive[k]
        for state in self.states:
            added, raised = state.follow(w, self.friction)
            net, level = net - added, level + raised
        gravity, load = self.load.follow(q)
        dry, loss = self.dry.follow(w, level if level > FORWARD.least_level else FORWARD.least_level, net - load)
        self.friction = dry + copysign(loss, w) + viscous
        self.loss[0], self.applied[0] = loss, net - dry - gravity


class _Gravity:
    """Gravity of the load."""

    def __init__(self, plant: Plant, rotary: bool) -> None:
        self.cosine, self.sine = plant.gravity if rotary else (0.0, 0.0)

    def compute_torque(self, position: float) -> float:
        """Torque at this position of the load [N·m]."""
        return self.cosine * cos(position) + self.sine * sin(position)


class _Rigid:
    """A load that moves with the motor."""

    def __init__(self, gravity: _Gravity) -> None:
        self.gravity = gravity

    def follow(self, q: float) -> tuple[float, float]:
        """Gravity, and torque that the load takes from the motor side [N·m], at the motor position [rad]."""
        torque = self.gravity.compute_torque(q)
        return torque, torque


class _Coupled:
    """A load behind a spring or a gap: the second body of the model, whose joint is its lead before the motor."""

    def __init__(self, gravity: _Gravity, coupling: Coupling, model: Any, data: Any) -> None:
        self.gravity, self.coupling, self.damping = gravity, coupling, model.dof_damping
        self.q, self.w, self.applied = data.qpos, data.qvel, data.qfrc_applied
        self.q[1] = coupling.compute_rest(gravity.compute_torque(data.qpos.item(0)))

    def follow(self, q: float) -> tuple[float, float]:
        """The same as of a rigid one; sets what acts on the load."""
        lead, rate = self.q.item(1), self.w.item(1)
        torque = self.gravity.compute_torque(q + lead)
        pull, damping = self.coupling.pull(lead, rate)
        self.applied[1], self.damping[1] = pull - torque, damping
        return torque, pull - damping * rate
