"""Joints that were recorded in another frame than the simulation has: torques the other way round or in another unit,
angles from another zero or in the other direction.

    τ = g τ_s + r a + F_c sign v + F_v v + b,   g, r, F_c, F_v ≥ 0

of each joint by itself, τ_s being what the simulation asks for. Friction that feeds energy in, or gravity that pulls
up, is no physics, and links would be fitted to it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from fricomp.laws import FloatArray
from fricomp.recording import Recording

from ..arm_recording import ArmRecording
from ..columns import plain_columns
from ..record import JointFrame
from ..rigid.simulated_arm import SimulatedArm
from ..rows import ArmRows, build_rows

_CUTOFF = 2.5
"""[Hz] up to which torques are compared: gravity and friction lie below."""

_OF_RATE = 0.2
"""Highest cutoff, as part of the sample rate."""

LEAST_ROWS = 20
"""Of the fit of five parameters."""

_FALL = 0.5
"""Part that a turned torque leaves at most, of what it leaves as it was recorded and of how much it varies: a joint
whose links are guessed is not turned."""

POOR = 0.4
"""Part of how much a joint's torque varies, from which on what is left of it asks for another frame. Links that are off
by a fifth leave half of that."""

_UNIT = 5.0
"""Factor on what the links ask for, or part of it, from which on a torque is one of another unit: no simulation is that
far off, and gears and units begin there."""

_EXPLAINED, _KNOWN = 0.3, 0.1
"""Part of how much a torque varies that is left of it at most, and relative deviation of that factor, to say so."""

_FRAME_FALL = 0.5
"""Part that another frame leaves at most, over all joints and of its own: links that are off make up for less."""

_EXPLAINS = 0.25
"""Part that another reading of a whole recording leaves at most, over all joints: half of two of them. Links that are
off do less."""

_QUARTER = 0.5 * np.pi
"""[rad] by which the zeros of a controller and of a simulation usually differ, if they do."""


def find_turned_torques(arm: SimulatedArm, recording: ArmRecording) -> tuple[str, ...]:
    """Names of joints whose torque is explained turned round, and is not as it was recorded; none of a short motion."""
    turned = []
    for name, (columns, torque) in zip(recording.joints, _build_plain(arm, recording), strict=False):
        as_recorded, other_way = (_measure_left(columns, way * torque) for way in (1.0, -1.0))
        if other_way < _FALL * min(as_recorded, float(np.std(torque))):
            turned.append(name)
    return tuple(turned)


def find_torque_scales(
    arm: SimulatedArm, recording: ArmRecording, inertia: FloatArray | None = None
) -> dict[str, float]:
    """Factor on what the links of a joint ask for, by its name, where it is one of another unit.

    Where links ask for little beside friction and the rotor, any factor is as good as none: it has to explain what the
    links as they are simulated leave. What the arm carries looks like a factor in the joint that carries little else;
    but other joints feel it as well.

    Args:
        arm: The simulation.
        recording: Of its joints.
        inertia: Of the links as they were found. Shape (n_links, 10).
    """
    scales = {}
    simulated, found = (
        [_split_links(*one) for one in _build_plain(arm, recording, links)] for links in (None, inertia)
    )
    falls = np.log([seen.alone / max(one.alone, 1e-300) for seen, one in zip(found, simulated, strict=True)])
    for j, (name, one) in enumerate(zip(recording.joints, simulated, strict=False)):
        carried = found[j].alone <= one.left and np.sum(np.delete(falls, j)) < np.log(_FRAME_FALL)
        clear = one.left < min(_EXPLAINED * one.spread, _FRAME_FALL * one.alone)
        known = one.deviation < _KNOWN * one.factor and not 1.0 / _UNIT < one.factor < _UNIT
        if clear and known and not carried:
            scales[name] = one.factor
    return scales


class _Split(NamedTuple):
    """A joint's torque as what its links ask for and the rest.

    Attributes:
        factor: On the links.
        deviation: Its standard deviation.
        left: Standard deviation of what is left with it [N·m] or [N].
        alone: The same with the links as they are.
        spread: Of the torque.
    """

    factor: float
    deviation: float
    left: float
    alone: float
    spread: float


def _split_links(columns: FloatArray, torque: FloatArray) -> _Split:
    kept = columns[:, :-1]  # what is constant comes once
    factors, left = _fit_freely(kept, torque)
    _, alone = _fit_freely(kept[:, 1:], torque - kept[:, 0])
    deviation = left * float(np.sqrt(np.linalg.pinv(kept.T @ kept)[0, 0]))
    return _Split(float(factors[0]), deviation, left, alone, float(np.std(torque)))


def _fit_freely(columns: FloatArray, torque: FloatArray) -> tuple[FloatArray, float]:
    """Factors of columns by least squares, and the standard deviation of what they leave [N·m] or [N]."""
    factors, _, _, _ = np.linalg.lstsq(columns, torque, rcond=None)
    return np.asarray(factors, dtype=np.float64), float(np.std(torque - columns @ factors))


def turn_torque(recording: Recording) -> Recording:
    """The recording with its torques the other way round."""
    channels = ("torque", "torque_command", "current")
    known = {name: getattr(recording, name) for name in channels}
    return recording.with_channels(**{name: -np.asarray(one) for name, one in known.items() if one is not None})


def find_better_frames(arm: SimulatedArm, recording: ArmRecording) -> tuple[JointFrame, ...]:
    """Frames in which the simulation would explain a recording that it hardly explains; none where it does."""
    found: dict[int, JointFrame] = {}
    left, poor = _measure_joints(arm, recording)
    while poor:
        tried = [
            (_measure_joints(arm, _place(recording, j, frame))[0], j, frame)
            for j, frame in _list_frames(arm)
            if j not in found
        ]
        best, j, frame = min(tried, key=lambda one: float(np.sum(np.log(one[0]))), default=(left, -1, None))
        falls = np.log(best / left)
        if frame is None or max(float(np.sum(falls)), float(falls[j])) > np.log(_FRAME_FALL):
            break
        found[j], recording = frame, _place(recording, j, frame)
        left, poor = _measure_joints(arm, recording)
    return tuple(found[j] for j in sorted(found))


def measure_frames(arm: SimulatedArm, recording: ArmRecording, frames: Sequence[JointFrame] = ()) -> float:
    """Sum over all joints of the logarithm of what the simulation leaves of them, some of them in other frames."""
    for frame in frames:
        recording = _place(recording, arm.joints.index(frame.joint), frame)
    return float(np.sum(np.log(_measure_joints(arm, recording)[0])))


def explains_better(left: float, before: float) -> bool:
    """Whether so little is left that links that are off could not be why; sums of logarithms over all joints."""
    return bool(left - before < np.log(_EXPLAINS))


def build_slow_rows(arm: SimulatedArm, recording: ArmRecording) -> ArmRows:
    """Rows of gravity and friction, which tell frames."""
    return build_rows(arm, recording, min(_CUTOFF, _OF_RATE / recording.period))


def _list_frames(arm: SimulatedArm) -> Iterator[tuple[int, JointFrame]]:
    for j, (name, rotary) in enumerate(zip(arm.joints, arm.rotary, strict=True)):
        for direction in (1, -1):
            for offset in (0.0, _QUARTER, -_QUARTER, 2.0 * _QUARTER) if rotary else (0.0,):
                if direction < 0 or offset:
                    yield j, JointFrame(joint=name, direction=direction, offset=offset)


def _place(recording: ArmRecording, joint: int, frame: JointFrame) -> ArmRecording:
    """The recording with one joint in another frame."""
    way = np.ones(len(recording.joints))
    zero = np.zeros_like(way)
    way[joint], zero[joint] = frame.direction, frame.offset
    parts = (replace(one, position=way * one.position + zero, torque=way * one.torque) for one in recording.parts)
    return replace(recording, parts=tuple(parts))


def _measure_joints(arm: SimulatedArm, recording: ArmRecording) -> tuple[FloatArray, bool]:
    """What is left of each joint, and whether it is much of one."""
    plain = _build_plain(arm, recording)
    left = np.array([_measure_left(columns, torque) for columns, torque in plain])
    spread = np.array([float(np.std(torque)) for _, torque in plain])
    return np.maximum(left, 1e-300), bool(np.any(left > POOR * spread))


def _build_plain(
    arm: SimulatedArm, recording: ArmRecording, inertia: FloatArray | None = None
) -> list[tuple[FloatArray, FloatArray]]:
    """Columns whose factors are not below zero, and the torque, of each joint; none where there are too few rows.

    Links are those of the simulation, or weigh `inertia`.
    """
    rows = build_slow_rows(arm, recording)
    if len(rows) < LEAST_ROWS:
        return []
    asked = rows.links @ (arm.inertia if inertia is None else inertia).ravel()
    acceleration = rows.compare(lambda _, __, a: a)
    plain = []
    for j in range(len(arm.joints)):
        sign, one, velocity, _ = plain_columns(rows, j).T
        columns = [asked[:, j], acceleration[:, j], sign, velocity, one, -one]
        plain.append((np.stack(columns, axis=1), rows.torque[:, j]))
    return plain


def _measure_left(columns: FloatArray, torque: FloatArray) -> float:
    """RMS of what columns times factors that are not below zero leave [N·m] or [N]."""
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    return float(nnls(columns / size, torque)[1] / np.sqrt(torque.size))
