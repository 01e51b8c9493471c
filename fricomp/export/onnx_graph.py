"""Friction as an ONNX graph: closed forms written out, and several joints' networks stacked into one."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.compensation.network_file import check_graph
from fricomp.control.compensation.trust import compute_torque_cap, find_doubt_in_status, require_usable, trusted_curves
from fricomp.errors import ExportError
from fricomp.export.joined_facts import join_facts
from fricomp.export.onnx_nodes import NodeWriter
from fricomp.export.onnx_terms import closed_form
from fricomp.extras import needing
from fricomp.laws import FloatArray, find_inputs
from fricomp.model import FrictionModel
from fricomp.untrusted import read_whole
from fricomp.whole_file import write_whole

__all__ = [
    "STATE_COLUMNS",
    "build_model",
    "closed_form_graph",
    "import_onnx",
    "save_graph",
    "stack_networks",
    "state_columns",
]

OPSET = 17
"""Operator set written; every operator used exists unchanged since set 13."""
STATE_COLUMNS = ("velocity", "normal_load", "position", "load_torque", "temperature", "acceleration")
"""Columns of the input of a closed form; the third to fifth only where a model depends on any of them, and the last one
only where a model depends on it."""
_IR_VERSION = 8


def closed_form_graph(models: Sequence[FrictionModel], *, any_status: bool = False) -> Any:
    """The closed forms of `models`: input `state`, output `torque`.

    The columns of the state are velocity and normal load; where a model has terms over them also position, load torque
    and temperature, all three, and where one has a term over the acceleration that too. One model takes any number of
    rows, shape (n, 2), (n, 5) or (n, 6) to (n, 1); several take one row each, in their order. Terms with a state are
    those of steady sliding. Where a model knows the friction of its data, the curve is held to `compute_torque_cap` at
    every speed. Terms that lower dry friction take no more than there is. The normal load of a model whose data had
    none and whose law says nothing about it changes nothing. Columns that no model uses stand in the metadata, key
    `unused`.

    Args:
        models: What is exported.
        any_status: Take models too that their identification calls unusable.

    Raises:
        ExportError: No model.
        ParameterError: A model is not usable.
        MissingExtraError: onnx is not installed.
    """
    onnx = import_onnx()
    if not models:
        raise ExportError("an ONNX graph needs at least one model")
    for model in models if not any_status else ():
        require_usable(model)
    curves, columns = [trusted_curves(model) for model in models], state_columns(models)
    writer = NodeWriter(onnx.helper.make_node)
    writer.write(closed_form(curves, [compute_torque_cap(model) for model in models]), "torque")
    rows: int | str = "n" if len(models) == 1 else len(models)
    nodes = [onnx.helper.make_node("Split", ["state"], columns, axis=1), *writer.nodes]
    graph = build_model(onnx, nodes, writer.constants, (rows, len(columns)))
    for key, value in _loads(models, curves).items():
        graph.metadata_props.add(key=key, value=value)
    if unused := [name for name in columns if not any(_depends_on(name, model) for model in models)]:
        graph.metadata_props.add(key="unused", value=f"{', '.join(unused)}: any finite number, it changes nothing")
    return graph


def _loads(models: Sequence[FrictionModel], curves: Sequence[FrictionCurves]) -> dict[str, str]:
    """What `NetworkCompensator` is told of the normal load of each joint, nothing where no friction follows it."""
    joints = list(zip(models, curves, strict=True))
    if not any(curve.load.load_sensitivity for curve in curves):
        return {}
    ranges = [model.validity.normal_load if curve.load.load_sensitivity else None for model, curve in joints]
    return {
        "normal_load_range": "; ".join(" ".join(f"{edge:.9g}" for edge in edges or ()) for edges in ranges),
        "reference_load": "; ".join(f"{curve.load.reference_load:.9g}" for curve in curves),
    }


def _depends_on(column: str, model: FrictionModel) -> bool:
    """Whether a column of the state changes the torque of a joint."""
    if column == "normal_load":
        return trusted_curves(model).load.load_sensitivity != 0.0
    return column == "velocity" or column in find_inputs(model.law.terms)


def state_columns(models: Sequence[FrictionModel]) -> tuple[str, ...]:
    """Columns of the input that the closed forms of `models` need."""
    inputs = find_inputs([term for model in models for term in model.law.terms])
    if "acceleration" in inputs:
        return STATE_COLUMNS
    return STATE_COLUMNS[:-1] if inputs else STATE_COLUMNS[:2]


def stack_networks(paths: Sequence[str | os.PathLike[str]], *, any_status: bool = False) -> Any:
    """The networks of several joints in one graph: input `state`, shape (n_joints, 2), output (n_joints, 1).

    Their layers are joined into block-diagonal ones and the normalisation is folded into the first and the last:
    few operators, each for all joints, which is what a call costs. The metadata are those of all files by `join_facts`.

    Args:
        paths: Networks that an identification wrote.
        any_status: Take networks too whose models their identification calls unusable.

    Raises:
        ExportError: No file, a file is no network of this library, their layers differ in number, or their ranges of
            velocity do not overlap.
        MissingExtraError: onnx is not installed.
    """
    onnx = import_onnx()
    networks = [_read_network(onnx, Path(path), any_status) for path in paths]
    tables = [table for table, _ in networks]
    depths = {sum(name.startswith("weight_") for name in table) for table in tables}
    if len(depths) != 1:
        raise ExportError(
            f"networks of {sorted(depths)} layers cannot be joined: give networks with as many layers each"
        )
    n_layers, n_joints = depths.pop(), len(tables)
    joints = [_folded_layers(table, n_layers) for table in tables]
    constants: dict[str, FloatArray] = {}
    node = onnx.helper.make_node
    nodes = [node("Reshape", ["state", "flat"], ["signal_0"])]
    for k in range(n_layers):
        constants[f"weight_{k}"] = _block_diagonal([layers[k][0] for layers in joints])
        constants[f"bias_{k}"] = np.concatenate([layers[k][1] for layers in joints])
        nodes.append(node("Gemm", [f"signal_{k}", f"weight_{k}", f"bias_{k}"], [f"affine_{k}"]))
        if k < n_layers - 1:
            nodes.append(node("Tanh", [f"affine_{k}"], [f"signal_{k + 1}"]))
    nodes.append(node("Reshape", [f"affine_{n_layers - 1}", "column"], ["torque"]))
    shapes = {"flat": np.array([1, 2 * n_joints]), "column": np.array([n_joints, 1])}
    integers = {name: values.astype(np.int64) for name, values in shapes.items()}
    graph = build_model(onnx, nodes, constants, (n_joints, 2), integers)
    for key, value in sorted(join_facts([about for _, about in networks]).items()):
        graph.metadata_props.add(key=key, value=value)
    return graph


def _folded_layers(table: dict[str, FloatArray], n_layers: int) -> list[tuple[FloatArray, FloatArray]]:
    """Weight, shape (n_in, n_out), and bias of each layer, with scaling and offset of input and output inside."""
    layers = [
        (table[f"weight_{k}"].T.astype(np.float64), table[f"bias_{k}"].astype(np.float64)) for k in range(n_layers)
    ]
    weight, bias = layers[0]
    weight = weight / table["input_scale"].reshape(-1, 1)
    layers[0] = weight, bias - table["input_offset"].reshape(-1) @ weight
    weight, bias = layers[-1]
    layers[-1] = weight * table["torque_scale"], bias * table["torque_scale"]
    return layers


def _block_diagonal(blocks: Sequence[FloatArray]) -> FloatArray:
    """The blocks along the diagonal of one matrix, zeros elsewhere."""
    matrix = np.zeros(tuple(sum(block.shape[axis] for block in blocks) for axis in (0, 1)))
    row = column = 0
    for block in blocks:
        matrix[row : row + block.shape[0], column : column + block.shape[1]] = block
        row, column = row + block.shape[0], column + block.shape[1]
    return matrix


def save_graph(graph: Any, path: str | os.PathLike[str], metadata: dict[str, str] | None = None) -> None:
    """Check and write a graph, whole or not at all; `metadata` goes before what the graph states itself.

    Raises:
        ExportError: The file cannot be written.
    """
    stated = {item.key: item.value for item in graph.metadata_props}
    del graph.metadata_props[:]
    for key, value in sorted((stated | {"opset": str(OPSET)} | (metadata or {})).items()):
        graph.metadata_props.add(key=key, value=value)
    import_onnx().checker.check_model(graph)
    write_whole(Path(path), graph.SerializeToString(), ExportError)


def import_onnx() -> Any:
    """The package, which carries no types.

    Raises:
        MissingExtraError: It is not installed.
    """
    with needing("onnx", "onnx"):
        import onnx
    return onnx


def _read_network(onnx: Any, path: Path, any_status: bool) -> tuple[dict[str, FloatArray], dict[str, str]]:
    """The weights of a network by name, and its metadata."""
    try:
        model = onnx.load_model_from_string(read_whole(path))
        check_graph(model)
        table = {item.name: onnx.numpy_helper.to_array(item) for item in model.graph.initializer}
    except Exception as error:  # protobuf raises its own kinds
        raise ExportError(f"cannot read the network {path}: {error}") from error
    about = {item.key: item.value for item in model.metadata_props}
    doubt = find_doubt_in_status(about.get("status", ""), about.get("message", ""))
    if doubt is not None and not any_status:
        raise ExportError(
            f"the network {path} is of a model that is not usable ({doubt}); identify it from better data, or pass "
            "any_status=True (--any-status) to use it all the same"
        )
    if not _is_network(table):
        raise ExportError(f"{path} is not a friction network of this library: export it with fricomp")
    return table, about


def _is_network(table: dict[str, FloatArray]) -> bool:
    """Whether these are the layers of one joint's network, each as wide as the next one takes, and all finite."""
    if not {"input_offset", "input_scale", "torque_scale"} <= set(table):
        return False
    width, n_layers = 2, sum(name.startswith("weight_") for name in table)
    for k in range(n_layers):
        weight, bias = table.get(f"weight_{k}"), table.get(f"bias_{k}")
        if weight is None or bias is None or weight.ndim != 2 or weight.shape != (bias.size, width):
            return False
        width = bias.size
    sizes = [table[name].size for name in ("input_offset", "input_scale", "torque_scale")]
    is_finite = all(values.dtype.kind == "f" and np.all(np.isfinite(values)) for values in table.values())
    return n_layers > 0 and width == 1 and sizes == [2, 2, 1] and is_finite and bool(np.all(table["input_scale"]))


def build_model(
    onnx: Any,
    nodes: list[Any],
    constants: dict[str, FloatArray],
    shape: tuple[int | str, int],
    integers: dict[str, Any] | None = None,
) -> Any:
    """The model of these nodes: input `state` of the shape given, output `torque` of as many rows.

    Args:
        onnx: The package.
        nodes: From `state` to `torque`.
        constants: Tensors by name, written as float32.
        shape: Rows, as a number or a name, and columns.
        integers: Tensors of whole numbers.
    """
    helper, FLOAT = onnx.helper, onnx.TensorProto.FLOAT
    tensors = [onnx.numpy_helper.from_array(value.astype(np.float32), name) for name, value in constants.items()]
    tensors += [onnx.numpy_helper.from_array(value, name) for name, value in (integers or {}).items()]
    graph = helper.make_graph(
        nodes,
        "friction_torque",
        [helper.make_tensor_value_info("state", FLOAT, shape)],
        [helper.make_tensor_value_info("torque", FLOAT, [shape[0], 1])],
        tensors,
    )
    opset = [helper.make_opsetid("", OPSET)]
    return helper.make_model(graph, opset_imports=opset, ir_version=_IR_VERSION, producer_name="fricomp")
