"""The extended law as ONNX: written out where the graph knows its terms, else learnt where velocity is all it needs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fricomp.calibration.network import distil, save_network
from fricomp.control import split_law
from fricomp.errors import DiagnosisError
from fricomp.export import closed_form_graph, save_graph
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

__all__ = ["needed_inputs", "save_extended_network"]

_PROBES = {"position": 1.7, "acceleration": 3.1, "load_torque": 2.3, "temperature": 41.0}
_ENOUGH = 5e-3  # largest deviation from the law, fraction of the largest torque, with which a network is written


def needed_inputs(model: FrictionModel) -> tuple[str, ...]:
    """Inputs besides velocity and normal load that the torque of `model` depends on."""
    low, high = _speeds(model)
    velocity = np.concatenate([np.linspace(low, high, 12), 1e-3 * np.linspace(low, high, 12)])
    plain = np.asarray(model.law.torque(velocity))
    scale = float(np.max(np.abs(plain))) or 1.0
    return tuple(
        name
        for name, value in _PROBES.items()
        if float(np.max(np.abs(np.asarray(model.law.torque(velocity, **{name: value})) - plain))) > 1e-9 * scale
    )


def save_extended_network(model: FrictionModel, path: Path) -> str:
    """Write `model` as ONNX, and say how near it is.

    Raises:
        DiagnosisError: The law needs inputs that the network does not have, or cannot be learnt by it.
        MissingExtraError: onnx is not installed.
    """
    foreign = [name.replace("_", " ") for name in needed_inputs(model)]
    if foreign:
        raise DiagnosisError(
            f"its inputs are velocity and normal load, and this law needs {', '.join(foreign)}; use friction.json"
        )
    memory = ", in steady sliding" if model.law.is_dynamic else ""
    if not split_law(model.law).extra:
        save_graph(closed_form_graph([model]), path, _metadata(model, "closed form"))
        return f"the same law as a graph; only rounding to single precision is lost{memory}"
    return f"the same law as a network, within {_learn(model, path):.2%} of its largest torque{memory}"


def _learn(model: FrictionModel, path: Path) -> float:
    """Train the network to the law over the velocities of the data; the largest deviation."""

    def torque(velocity: FloatArray, _: FloatArray | None) -> FloatArray:
        return np.asarray(model.law.torque(velocity), dtype=np.float64)

    top = float(np.max(np.abs(_speeds(model))))
    bends = [value for name, value in model.law.parameters().items() if name.endswith("stribeck_velocity")]
    result = distil(torque, top, bend=min(bends, default=0.01 * top) / top)
    if result.largest_error > _ENOUGH:
        raise DiagnosisError(f"the network comes only within {result.largest_error:.1%} of this law; use friction.json")
    save_network(result.network, path, _metadata(model, "network trained on the closed form"))
    return result.largest_error


def _speeds(model: FrictionModel) -> tuple[float, float]:
    low, high = model.validity.velocity or (-1.0, 1.0)
    return min(low, -1e-6), max(high, 1e-6)


def _metadata(model: FrictionModel, made: str) -> dict[str, str]:
    low, high = _speeds(model)
    return {
        "input": f"velocity [{model.position_unit}/s], normal_load",
        "output": f"friction torque [{model.torque_unit}]",
        "joint": model.joint,
        "velocity_range": f"{low:.9g} {high:.9g}",
        "made_from": f"the extended law of a diagnosis: {made}",
    }
