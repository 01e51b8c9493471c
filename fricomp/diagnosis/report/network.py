"""The extended law as ONNX: written out where the graph knows its terms, else learnt where velocity is all it needs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fricomp.calibration.network import distil, save_network
from fricomp.errors import DiagnosisError, ExportError
from fricomp.export import closed_form_graph, save_graph, state_columns
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .settings import REPORT

_PLAIN = ("velocity", "normal_load")  # inputs of a network


def save_extended_network(model: FrictionModel, path: Path) -> str:
    """Write `model` as ONNX, and say how near it is.

    Raises:
        DiagnosisError: The law has a term that neither the graph nor a network of the velocity can hold.
        MissingExtraError: onnx is not installed.
    """
    memory = ", in steady sliding" if model.law.is_dynamic else ""
    try:
        graph, inputs = closed_form_graph([model]), state_columns([model])
    except ExportError as error:
        if len(state_columns([model])) > len(_PLAIN):
            raise DiagnosisError(f"{error}; use friction.json") from error
        return f"the same law as a network, within {_learn(model, path):.2%} of its largest torque{memory}"
    save_graph(graph, path, _describe_network(model, "closed form", inputs))
    return f"the same law as a graph of {', '.join(inputs)}; only rounding to single precision is lost{memory}"


def _learn(model: FrictionModel, path: Path) -> float:
    """Train the network to the law over the velocities of the data; the largest deviation."""

    def compute_torque(velocity: FloatArray, _: FloatArray | None) -> FloatArray:
        return np.asarray(model.law.torque(velocity), dtype=np.float64)

    top = float(np.max(np.abs(_list_speeds(model))))
    bends = [value for name, value in model.law.parameters().items() if name.endswith("stribeck_velocity")]
    result = distil(compute_torque, top, bend=min(bends, default=0.01 * top) / top)
    if result.largest_error > REPORT.network:
        raise DiagnosisError(f"the network comes only within {result.largest_error:.1%} of this law; use friction.json")
    save_network(result.network, path, _describe_network(model, "network trained on the closed form", _PLAIN))
    return result.largest_error


def _list_speeds(model: FrictionModel) -> tuple[float, float]:
    low, high = model.validity.velocity or (-1.0, 1.0)
    return min(low, -1e-6), max(high, 1e-6)


def _describe_network(model: FrictionModel, made: str, inputs: Sequence[str]) -> dict[str, str]:
    low, high = _list_speeds(model)
    return {
        "input": f"{', '.join(inputs)}; velocity in {model.position_unit}/s, torque in {model.torque_unit}",
        "output": f"friction torque [{model.torque_unit}]",
        "joint": model.joint,
        "velocity_range": f"{low:.9g} {high:.9g}",
        "made_from": f"the extended law of a diagnosis: {made}",
    }
