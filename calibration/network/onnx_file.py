"""A network as ONNX: plain operators, float32, the normalisation inside the graph."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import ExportError, MissingExtraError
from fricomp.whole_file import write_whole

from .architecture import TanhNetwork

OPSET = 17
"""Operator set written; every operator used exists unchanged since set 13."""
_IR_VERSION = 8


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
    try:
        import onnx
    except ImportError:
        raise MissingExtraError("onnx", "calibrate") from None
    model = _graph_model(network, onnx)
    for key, value in sorted(({"opset": str(OPSET)} | dict(metadata)).items()):
        model.metadata_props.add(key=key, value=value)
    onnx.checker.check_model(model)
    write_whole(Path(path), model.SerializeToString(), ExportError)


def _graph_model(network: TanhNetwork, onnx: Any) -> Any:
    helper, FLOAT = onnx.helper, onnx.TensorProto.FLOAT
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
    graph = helper.make_graph(
        nodes,
        "friction_torque",
        [helper.make_tensor_value_info("state", FLOAT, ["n", 2])],
        [helper.make_tensor_value_info("torque", FLOAT, ["n", 1])],
        [onnx.numpy_helper.from_array(v.astype(np.float32), name) for name, v in constants.items()],
    )
    opset = [helper.make_opsetid("", OPSET)]
    return helper.make_model(graph, opset_imports=opset, ir_version=_IR_VERSION, producer_name="fricomp")
