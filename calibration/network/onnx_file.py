"""A network as ONNX: plain operators, float32, the normalisation inside the graph."""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from fricomp.export.onnx_graph import build_model, import_onnx, save_graph

from .architecture import TanhNetwork


def save_network(network: TanhNetwork, path: str | os.PathLike[str], metadata: Mapping[str, str]) -> None:
    """Write `network` as ONNX: input `state` (velocity, normal load), shape (n, 2); output `torque`, shape (n, 1).

    Args:
        network: The network.
        path: File to write, whole or not at all.
        metadata: Units, range, hashes and the like, kept in the file's metadata.

    Raises:
        MissingExtraError: onnx is not installed.
        ExportError: The file cannot be written.
    """
    save_graph(_build_graph(network, import_onnx()), path, dict(metadata))


def _build_graph(network: TanhNetwork, onnx: Any) -> Any:
    helper = onnx.helper
    constants = {
        "input_offset": np.array([0.0, network.load_offset]),
        "input_scale": np.array([network.velocity_scale, network.load_scale]),
        "torque_scale": np.array([network.torque_scale]),
    }
    nodes = [
        helper.make_node("Sub", ["state", "input_offset"], ["centred"]),
        helper.make_node("Div", ["centred", "input_scale"], ["signal_0"]),
    ]
    for k, layer in enumerate(network.layers):
        constants |= {f"weight_{k}": layer.weight, f"bias_{k}": layer.bias}
        nodes.append(helper.make_node("Gemm", [f"signal_{k}", f"weight_{k}", f"bias_{k}"], [f"affine_{k}"], transB=1))
        if k < len(network.layers) - 1:
            nodes.append(helper.make_node("Tanh", [f"affine_{k}"], [f"signal_{k + 1}"]))
    nodes.append(helper.make_node("Mul", [f"affine_{len(network.layers) - 1}", "torque_scale"], ["torque"]))
    return build_model(onnx, nodes, constants, ("n", 2))
