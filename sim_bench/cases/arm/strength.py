"""How strong a concealed effect is in its joint: its torque after a refit of the joint's base, over the noise.

Rows are means over 0.1 s, as far as an arm's equations are compared, in which the joint never sticks: while it does, no
equation of motion says what its torque is. The base is dry and viscous friction both ways, a
Stribeck curve, the joint's acceleration, its gravity torque, and its whole rigid torque: what a refit of the links
could make up for in this one joint, all others left aside.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .friction import PLACE, compute_friction
from .joints import ArmChange
from .links import compute_torques
from .plant import PERIOD, ArmRun

_BLOCK = 50  # samples of a row


def measure_strength(
    model: Any,
    run: ArmRun,
    base: NDArray[np.float64],
    effect: tuple[int, ArmChange],
    noise: NDArray[np.float64],
) -> float:
    """Effect-to-noise ratio.

    Args:
        model: The true arm.
        run: What happened.
        base: Friction of healthy joints.
        effect: Number of the joint, and the change.
        noise: Of the joint's torque [N·m]. Shape (n,).
    """
    joint, change = effect
    torque = _average(_compute_effect(model, run, base, joint, change))
    q, v = (_average(each) for each in (run.position, run.velocity))
    a = _average(np.gradient(run.velocity, PERIOD, axis=0))
    rigid, still = compute_torques(model, q, v, a)[:, joint], compute_torques(model, q, 0.0 * v, 0.0 * a)[:, joint]
    s, speed = _average(np.sign(run.velocity[:, joint])), v[:, joint]
    bend = _average(
        np.sign(run.velocity[:, joint])
        * np.exp(-((run.velocity[:, joint] / base[joint, PLACE["stribeck_velocity"]]) ** 2))
    )
    columns = np.column_stack([s, np.ones_like(s), speed, np.abs(speed), bend, a[:, joint], still, rigid])
    slides = _average((run.velocity[:, joint] == 0.0).astype(np.float64)) == 0.0
    columns, torque = columns[slides], torque[slides]
    left = torque - columns @ np.linalg.lstsq(columns, torque, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2)) / np.sqrt(np.mean(_average(noise) ** 2)))


def _average(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    rows = len(samples) // _BLOCK
    return np.asarray(samples[: rows * _BLOCK].reshape(rows, _BLOCK, *samples.shape[1:]).mean(axis=1))


def _compute_effect(
    model: Any, run: ArmRun, base: NDArray[np.float64], joint: int, change: ArmChange
) -> NDArray[np.float64]:
    """Torque of the effect along the motion [N·m]. Shape (n,)."""
    if change.gap is not None:
        a = np.gradient(run.velocity, PERIOD, axis=0)
        plain = compute_torques(model, run.position, run.velocity, a)
        return np.asarray(
            (run.torque - plain - compute_friction(base, run.position, run.velocity, run.load, run.heat))[:, joint]
        )
    if change.gain != 1.0 or change.delay:
        late = np.interp(run.time - change.delay, run.time, run.torque[:, joint])
        return np.asarray(change.gain * late - run.torque[:, joint])
    table = base.copy()
    for name, value in change.fields.items():
        table[joint, PLACE[name]] = value
    with_it, without = (
        compute_friction(each, run.position, run.velocity, run.load, run.heat)[:, joint] for each in (table, base)
    )
    torque = with_it - without
    if distance := change.fields.get("breakaway"):
        level = 0.5 * (base[joint, PLACE["coulomb_forward"]] + base[joint, PLACE["coulomb_reverse"]])
        torque = torque + level * (_turn(run.position[:, joint], distance) - np.sign(run.velocity[:, joint]))
    return np.asarray(torque)


def _turn(position: NDArray[np.float64], distance: float) -> NDArray[np.float64]:
    """Part of its level that a bristle holds along a path. Shape (n,)."""
    z, result = 0.0, np.zeros_like(position)
    for k, step in enumerate(np.diff(position), start=1):
        z = (z + step / distance) / (1.0 + abs(step) / distance)
        result[k] = z
    return result
