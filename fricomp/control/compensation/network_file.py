"""The file of a friction network: opened, and what its metadata say."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import ModelFileError, ParameterError
from fricomp.extras import needing
from fricomp.untrusted import read_whole

_GROWING = frozenset(
    ("ConstantOfShape", "Expand", "EyeLike", "GridSample", "OneHot", "Pad", "RandomNormal", "RandomNormalLike",
     "RandomUniform", "RandomUniformLike", "Range", "Resize", "ScatterND", "Tile", "Upsample", "ConvTranspose")
)  # fmt: skip
"""Nodes whose result may be of any size, whatever goes into them; no friction network needs them."""


class Loads(NamedTuple):
    """Normal loads of one joint of a network.

    Attributes:
        low: Lowest one that the network knows; minus infinity where none is stated.
        high: Highest one; infinity where none is stated.
        usual: The one assumed until one is given.
    """

    low: float = -math.inf
    high: float = math.inf
    usual: float = 1.0


def open_network(path: Path) -> Any:
    """A session of onnxruntime on one thread, of a network whose state is velocity and normal load.

    Raises:
        MissingExtraError: onnxruntime is not installed.
        ModelFileError: The file is no friction network.
    """
    session = open_graph(path)
    shapes = [tuple(item.shape[1:]) for item in (*session.get_inputs(), *session.get_outputs())]
    if shapes != [(2,), (1,)]:
        raise ModelFileError(f"{path} is no friction network: it must take `state` (n, 2) and give `torque` (n, 1)")
    return session


def open_graph(path: Path) -> Any:
    """A session of onnxruntime on one thread, of a network or closed form with any number of columns.

    Raises:
        MissingExtraError: onnxruntime is not installed.
        ModelFileError: The file holds no friction of one joint.
    """
    with needing("onnxruntime", "onnx"):
        import onnxruntime
    _require_small_graph(path)
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.execution_mode = onnxruntime.ExecutionMode.ORT_SEQUENTIAL
    options.log_severity_level = 3
    try:
        session = onnxruntime.InferenceSession(
            str(path), options, providers=["CPUExecutionProvider"], enable_fallback=0
        )  # which would print its complaint and try the same again
    except Exception as error:  # the runtime raises its own kinds, and bare ones
        raise ModelFileError(f"cannot read the network {path}: {error}") from error
    inputs, outputs = session.get_inputs(), session.get_outputs()
    if [one.name for one in inputs] != ["state"] or [len(one.shape) for one in (*inputs, *outputs)] != [2, 2]:
        raise ModelFileError(f"{path} is no friction network: it must take `state` (n, 2) and give `torque` (n, 1)")
    return session


def _require_small_graph(path: Path) -> None:
    """Refuse a graph that takes memory out of proportion to its file, or reads other files, before it is run.

    Raises:
        MissingExtraError: onnx is not installed.
        ModelFileError: It is no ONNX file, is too large, or has a node that makes tensors of any size.
    """
    with needing("onnx", "onnx"):
        import onnx
    try:
        model = onnx.load_model_from_string(read_whole(path))
        grown, is_apart = _list_growing(model.graph), _is_apart(model.graph)
        if not (grown or is_apart):
            check_graph(model)
    except Exception as error:  # protobuf raises kinds of its own
        raise ModelFileError(f"cannot read the network {path}: {error}") from error
    if grown:
        raise ModelFileError(
            f"{path} is no friction network: it has a node {grown[0]}, which makes tensors of any size"
        )
    if is_apart:
        raise ModelFileError(f"{path} takes weights from other files: put them into the network's own")


def _list_growing(graph: Any) -> list[str]:
    """Operators that make tensors of any size."""
    return sorted({node.op_type for node in graph.node if node.op_type in _GROWING or _has_graph(node)})


def _is_apart(graph: Any) -> bool:
    """Whether weights are in other files."""
    return any(tensor.external_data for tensor in graph.initializer)


def check_graph(model: Any) -> None:
    """Refuse a model whose operators, types or texts are not what ONNX allows.

    Raises:
        Exception: Of any kind, as the parsers have them: the model is damaged.
    """
    import onnx

    onnx.checker.check_model(model)
    for item in model.metadata_props:
        str.encode(item.key + item.value)  # what is no UTF-8 comes as bytes, or raises by itself


def _has_graph(node: Any) -> bool:
    """Whether a node runs a graph of its own, as a loop does."""
    return any(part.HasField("g") or part.graphs for part in node.attribute)


def read_velocity_range(given: tuple[float, float] | None, about: Mapping[str, str]) -> tuple[float, float]:
    """Range of velocity, as given or as the file states it [rad/s] or [m/s].

    Raises:
        ParameterError: What was given is no range, or nothing states one.
        ModelFileError: What the file states is no range.
    """
    if given is not None:
        if not (len(given) == 2 and -math.inf < given[0] < given[1] < math.inf):
            raise ParameterError(f"velocity_range must be two finite numbers in ascending order, got {given!r}")
        return given
    words = about.get("velocity_range", "").split()
    if len(words) != 2:
        raise ParameterError("the network's file states no range of velocity: give velocity_range=(low, high)")
    low, high = (_read_number(word) for word in words)
    if not -math.inf < low < high < math.inf:
        raise ModelFileError(
            f"the network's file states the range of velocity {' '.join(words)!r}: two finite numbers in ascending "
            "order are needed; export it anew"
        )
    return low, high


def read_largest_torques(about: Mapping[str, str], n_joints: int) -> NDArray[np.float64]:
    """Largest torque that was measured on each joint, as the file states it: one number for all joints or one a joint.

    Infinity where nothing is stated, and where a file of several joints says so of one. Shape (1,) or (n_joints,).

    Raises:
        ModelFileError: It states another number of them, or one is not positive, or the only one not finite.
    """
    if "largest_torque" not in about:
        return np.array([math.inf])
    words = about["largest_torque"].split()
    if len(words) not in (1, n_joints):
        raise ModelFileError(f"the network of {n_joints} joints states {len(words)} largest torques; export it anew")
    largest = np.array([_read_number(word) for word in words])
    if not np.all(largest > 0.0) or (len(words) == 1 and not np.isfinite(largest[0])):
        raise ModelFileError(
            f"the network's file states {about['largest_torque']!r} as the largest torque measured: it must be finite "
            "and positive; export it anew"
        )
    return largest


def read_loads(about: Mapping[str, str], n_joints: int) -> list[Loads]:
    """Normal loads of each joint, as the file states them: once for all joints or between semicolons.

    The usual load is `reference_load` where that is stated, else the middle of `normal_load_range`, else 1.

    Raises:
        ModelFileError: It states those of another number of joints, or what is no range or no load.
    """
    ranges = _read_each("normal_load_range", about, n_joints)
    return [_read_loads(*each) for each in zip(ranges, _read_each("reference_load", about, n_joints), strict=True)]


def _read_each(key: str, about: Mapping[str, str], n_joints: int) -> list[list[float]]:
    """The numbers of `key` for each joint."""
    parts = about.get(key, "").split(";")
    if len(parts) not in (1, n_joints):
        raise ModelFileError(f"the network of {n_joints} joints states {key} of {len(parts)}; export it anew")
    return [[_read_number(word) for word in part.split()] for part in parts] * (n_joints if len(parts) == 1 else 1)


def _read_loads(edges: list[float], reference: list[float]) -> Loads:
    is_range = not edges or (len(edges) == 2 and -math.inf < edges[0] <= edges[1] < math.inf)
    if not is_range or len(reference) > 1 or not all(math.isfinite(load) for load in reference):
        raise ModelFileError(
            f"the network's file states the normal loads {edges} and the reference load {reference}: two finite "
            "numbers in ascending order and a finite one are needed; export it anew"
        )
    if not edges:
        return Loads(usual=reference[0]) if reference else Loads()
    low, high = edges
    return Loads(low, high, min(max(reference[0], low), high) if reference else (low + high) / 2.0)


def _read_number(word: str) -> float:
    """What a word of a file means; NaN where it is no number."""
    try:
        return float(word)
    except ValueError:
        return math.nan
