"""Made joints for the tests of the evaluator: equations, reader of model files and errors of the tests' own.

Nothing here imports a law, a model or the evaluator: what both say alike, two codes say.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

__all__ = ["KINDS", "Made", "make_joint", "predict_torque", "read_numbers", "torque_error"]

Floats = NDArray[np.float64]

KINDS = ("null", "load", "cogging", "presliding", "lag")
DT = 2e-3
NOISE = 0.004
"""White noise of the recorded torque [N·m]."""
SUBSTEPS = 20
INERTIA, GRAVITY = 0.03, (0.9, 0.4)
FORWARD = {"coulomb_torque": 0.3, "static_torque": 0.4, "stribeck_velocity": 0.06, "viscous_coefficient": 0.1}
REVERSE = {"coulomb_torque": 0.33, "static_torque": 0.42, "stribeck_velocity": 0.07, "viscous_coefficient": 0.12}
LOAD, COGGING, SIGMA, LAG = 0.2, (0.08, 0.05, 30.0), (60.0, 0.3), 0.03


@dataclass(frozen=True)
class Made:
    """Samples of a made joint. Arrays of shape (n,)."""

    time: Floats
    position: Floats
    velocity: Floats
    torque: Floats


def make_joint(kind: str, duration: float = 16.0, seed: int = 0) -> Made:
    """Move a joint in closed loop, in steps of a tenth of a millisecond, by explicit equations."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(duration / DT), dtype=np.float64) * np.float64(DT)
    waves = np.array([(0.8, 0.13, 0.0), (0.3, 0.41, 1.0), (0.1, 1.3, 2.0)])
    reference = waves[:, 0] @ np.sin(2.0 * np.pi * np.outer(waves[:, 1], t) + waves[:, 2:])
    rate = np.gradient(reference, DT)
    h, q, v, felt, z = DT / SUBSTEPS, float(reference[0]), 0.0, 0.0, 0.0
    rows = np.empty((3, t.size))
    for k in range(t.size):
        drive = INERTIA * (900.0 * (reference[k] - q) + 60.0 * (rate[k] - v))
        rows[:, k] = q, v, drive
        for _ in range(SUBSTEPS):
            gravity = GRAVITY[0] * np.cos(q) + GRAVITY[1] * np.sin(q)
            felt += (v - felt) * h / LAG
            curve = FORWARD if v >= 0.0 else REVERSE
            speed = felt if kind == "lag" else v
            excess = curve["static_torque"] - curve["coulomb_torque"]
            level = curve["coulomb_torque"] + excess * np.exp(-((speed / curve["stribeck_velocity"]) ** 2))
            drag = curve["viscous_coefficient"] * speed
            level += LOAD * abs(gravity) if kind == "load" else 0.0
            wave = COGGING[0] * np.sin(COGGING[2] * q) + COGGING[1] * np.cos(COGGING[2] * q)
            net = drive - gravity - drag - (wave if kind == "cogging" else 0.0)
            if kind == "presliding":
                slope = v - SIGMA[0] * abs(v) * z / level
                net, level, z = net - SIGMA[0] * z - SIGMA[1] * slope, 0.0, z + h * slope
            push = v + h * net / INERTIA
            v = float(np.sign(push)) * max(abs(push) - h * level / INERTIA, 0.0)
            q += h * v
    position, velocity, torque = rows
    step = 2.0 * np.pi / 2**18
    rounded = np.asarray(np.round(position / step) * step, dtype=np.float64)
    return Made(t, rounded, velocity, torque + NOISE * rng.normal(size=t.size))


def read_numbers(path: Path) -> tuple[dict[str, dict[str, float]], dict[str, float]]:
    """Parameters of each term, and the rest of the equation, from the JSON of a model file."""
    content: dict[str, Any] = json.loads(path.read_text())
    terms = {
        term["term"]: {name: quantity["value"] for name, quantity in term["parameters"].items()}
        for term in content["law"]
    }
    return terms, {name: quantity["value"] for name, quantity in content["dynamics"].items()}


def torque_error(path: Path, made: Made, band: float) -> float:
    """RMS error of a model file over a recording below `band`, in motion, by equations of the tests' own."""
    dt = float(made.time[1] - made.time[0])
    q = _filter(made.position, 1.2 * band, dt)
    v = np.gradient(q, dt)
    a = np.gradient(v, dt)
    rest = 0.02 * float(np.quantile(np.abs(v), 0.98))
    predicted = predict_torque(path, made, v, a, rest)
    acted = np.interp(made.time + read_numbers(path)[1]["torque_delay"], made.time, made.torque)
    left = _filter(acted - predicted, band, dt)
    rows = np.abs(v) > rest
    edge = int(2.0 / band / dt) + 1
    rows[:edge] = rows[-edge:] = False
    return float(np.sqrt(np.mean(left[rows] ** 2)))


def predict_torque(path: Path, made: Made, v: Floats, a: Floats, rest: float) -> Floats:
    """Torque of a model file along a motion; a resting joint takes what the drive gives, if friction can hold it."""
    terms, body = read_numbers(path)
    q, dt = made.position, float(made.time[1] - made.time[0])
    load = body["gravity_cosine"] * np.cos(q) + body["gravity_sine"] * np.sin(q)
    smooth = body["inertia"] * a + load + body["offset"]
    load = load + body["load_inertia"] * a
    core = next(terms[name] for name in ("stribeck", "lugre", "lagged_stribeck", "lagged_lugre") if name in terms)
    speed = _lag(v, core["lag"], dt) if "lag" in core else v
    sides = [{n.split(".")[1]: x for n, x in core.items() if n.startswith(side)} for side in ("forward", "reverse")]
    dry, drag = (np.where(v >= 0.0, *pair) for pair in zip(*(_curve(side, speed) for side in sides), strict=True))
    smooth = smooth + drag
    for name, values in terms.items():
        if name == "cogging":
            angle = values["order"] * q
            smooth = smooth + values["sine"] * np.sin(angle) + values["cosine"] * np.cos(angle)
        elif name == "load_coulomb":
            dry = dry + values["coefficient"] * np.abs(load)
        elif name == "load_quadratic":
            dry = dry + values["coefficient"] * load**2
        elif "coulomb_torque" not in str(values):
            raise AssertionError(f"the tests have no equation of {name}")
    if "sigma_0" in core:
        return np.asarray(smooth + _bend(v, dry, core["sigma_0"], core["sigma_1"], dt))
    acted = np.interp(made.time + body["torque_delay"], made.time, made.torque)
    held = np.clip(acted - smooth, -dry, dry)
    return np.asarray(smooth + np.where(np.abs(v) > rest, dry * np.sign(v), held))


def _curve(side: dict[str, float], speed: Floats) -> tuple[Floats, Floats]:
    fall = np.exp(-((np.abs(speed) / side["stribeck_velocity"]) ** side["stribeck_exponent"]))
    level = side["coulomb_torque"] + (side["static_torque"] - side["coulomb_torque"]) * fall
    return level, side["viscous_coefficient"] * speed


def _lag(v: Floats, lag: float, dt: float) -> Floats:
    felt, result = 0.0, np.empty_like(v)
    keep = float(np.exp(-dt / lag))
    for k, value in enumerate(v.tolist()):
        felt = value + (felt - value) * keep
        result[k] = felt
    return result


def _bend(v: Floats, level: Floats, sigma_0: float, sigma_1: float, dt: float) -> Floats:
    z, result = 0.0, np.empty_like(v)
    for k, (speed, most) in enumerate(zip(v.tolist(), level.tolist(), strict=True)):
        before, end = z, most / sigma_0 * float(np.sign(speed))
        z = end + (z - end) * float(np.exp(-abs(speed) * dt * sigma_0 / most))
        result[k] = sigma_0 * z + sigma_1 * (z - before) / dt
    return result


def _filter(values: Floats, cutoff: float, dt: float) -> Floats:
    result: Floats = sosfiltfilt(butter(4, cutoff, fs=1.0 / dt, output="sos"), values)
    return result
