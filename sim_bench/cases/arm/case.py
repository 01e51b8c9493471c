"""A concealed arm: drawn, moved, sensed, and how strong each of its effects is."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .friction import FIELDS, PLACE
from .joints import ArmChange, JointScene, change_joint, draw_friction
from .links import build_true_arm, compute_torques, read_believed_arm
from .motion import ArmReference, build_motion
from .plant import PERIOD, ArmRun, run_arm
from .spec import JOINTS, ArmSpec
from .strength import measure_strength

_WARMING, _WARM_TIME = (4.0, 15.0), (20.0, 120.0)  # [K], [s]
_NOISE = 0.03  # of a joint's Coulomb torque: white noise of a current, and most of it again that is slow
_SLOW = 3.0  # [Hz] below which the slow noise lies
_COUNT = 2e-3  # of a joint's Coulomb torque: step of the current's converter
_BITS = (17, 18, 19, 20)  # of encoders on the joint's side
_DELAY = 4e-3  # [s], the most that all torques are late


@dataclass(frozen=True)
class ConcealedEffect:
    """One effect in one joint.

    Attributes:
        joint: Name.
        name: The catalogue's.
        change: What it sets.
        enr: Effect-to-noise ratio after a refit of the joint's base.
    """

    joint: str
    name: str
    change: ArmChange
    enr: float


@dataclass(frozen=True)
class ArmCase:
    """A recording with its truth.

    Attributes:
        spec: Of the case.
        model: The true arm.
        off: Names of the links that are far off.
        table: Friction with all effects. Shape (6, n_fields).
        effects: What is concealed.
        delay: By which all torques are late [s].
        time: [s]. Shape (n,).
        channels: Of each joint, by its name.
    """

    spec: ArmSpec
    model: Any
    off: tuple[str, ...]
    table: NDArray[np.float64]
    effects: tuple[ConcealedEffect, ...]
    delay: float
    time: NDArray[np.float64]
    channels: Mapping[str, Mapping[str, NDArray[np.float64]]]


def generate_arm(spec: ArmSpec) -> ArmCase:
    """Make a concealed arm; the same spec makes the same one.

    Raises:
        DiagnosisError: The loop loses its reference.
    """
    rngs = [np.random.default_rng(one) for one in np.random.SeedSequence(spec.seed).spawn(6)]
    model, off = build_true_arm(rngs[0], spec.wrong_links)
    believed = read_believed_arm()
    time: NDArray[np.float64] = np.asarray(PERIOD * np.arange(round(spec.duration / PERIOD)), dtype=np.float64)
    reference = build_motion(rngs[1], time)
    heat = _warm(rngs[2], time)
    base = draw_friction(rngs[3])
    scenes = _describe_joints(model, base, reference, heat)
    changes = [
        (joint, name, change_joint(name, scenes[joint], np.random.default_rng([spec.seed, 2, k])))
        for k, (joint, name) in enumerate(spec.effects)
    ]
    table = base.copy()
    for joint, _, change in changes:
        for name, value in change.fields.items():
            table[JOINTS.index(joint), PLACE[name]] = value
    gap = next((change.gap for _, _, change in changes if change.gap is not None), None)
    run = run_arm(model, believed, table, reference, heat, gap)
    delay = float(rngs[4].uniform(0.0, _DELAY))
    noise = _draw_noise(rngs[5], base, len(time))
    recorded = _record_torque(run, changes, delay)
    strengths = [
        measure_strength(model, run, base, (JOINTS.index(joint), change), noise[:, JOINTS.index(joint)])
        for joint, _, change in changes
    ]
    effects = tuple(ConcealedEffect(*each, enr) for each, enr in zip(changes, strengths, strict=True))
    channels = _sense(rngs[4], run, recorded + noise, base)
    return ArmCase(spec, model, off, table, effects, delay, run.time, channels)


def _warm(rng: np.random.Generator, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Temperatures over that of the start [K]. Shape (n, 6)."""
    rises, times = rng.uniform(*_WARMING, 6), rng.uniform(*_WARM_TIME, 6)
    return np.asarray(rises * (1.0 - np.exp(-time[:, None] / times)))


def _describe_joints(
    model: Any, base: NDArray[np.float64], reference: ArmReference, heat: NDArray[np.float64]
) -> dict[str, JointScene]:
    thin = slice(None, None, 25)  # 20 Hz: enough for what is typical
    load = compute_torques(model, *(each[thin] for each in reference))
    load -= reference.acceleration[thin] * model.dof_armature
    return {
        name: JointScene(
            number=j,
            fields=dict(zip(FIELDS, base[j].tolist(), strict=True)),
            load=float(np.sqrt(np.mean(load[:, j] ** 2))),
            speed=float(np.abs(reference.velocity[:, j]).max()),
            middle=float(reference.position[:, j].mean()),
            warming=float(heat[-1, j]),
        )
        for j, name in enumerate(JOINTS)
    }


def _record_torque(run: ArmRun, changes: list[tuple[str, str, ArmChange]], delay: float) -> NDArray[np.float64]:
    """Torques as drives report them, without noise [N·m]. Shape (n, 6)."""
    late, gain = np.full(6, delay), np.ones(6)
    for joint, _, change in changes:
        late[JOINTS.index(joint)] += change.delay
        gain[JOINTS.index(joint)] *= change.gain
    middle = run.time + 0.5 * PERIOD  # each sample is the mean until the next one
    columns = [np.interp(run.time - late[j], middle, run.torque[:, j]) for j in range(6)]
    return np.asarray(np.stack(columns, axis=1) * gain)


def _draw_noise(rng: np.random.Generator, base: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    size = _NOISE * 0.5 * (base[:, PLACE["coulomb_forward"]] + base[:, PLACE["coulomb_reverse"]])
    white = rng.standard_normal((n, 6))
    keep = np.exp(-2.0 * np.pi * _SLOW * PERIOD)
    slow, state = np.empty((n, 6)), rng.standard_normal(6)
    push = np.sqrt(1.0 - keep**2) * rng.standard_normal((n, 6))
    for k in range(n):
        state = keep * state + push[k]
        slow[k] = state
    return np.asarray((white + 0.7 * slow) * size)


def _sense(
    rng: np.random.Generator, run: ArmRun, torque: NDArray[np.float64], base: NDArray[np.float64]
) -> dict[str, dict[str, NDArray[np.float64]]]:
    bits = rng.choice(_BITS, 6)
    channels = {}
    for j, name in enumerate(JOINTS):
        step, count = 2.0 * np.pi / 2.0 ** int(bits[j]), _COUNT * base[j, PLACE["coulomb_forward"]]
        warmth = 24.0 + run.heat[:, j] + 0.05 * rng.standard_normal(run.time.size)
        channels[name] = {
            "position": np.round(run.position[:, j] / step) * step,
            "torque": np.round(torque[:, j] / count) * count,
            "temperature": np.round(warmth, 1),
        }
    return channels
