"""The file of a friction network: opened, and what its metadata say."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import MissingExtraError, ModelFileError, ParameterError

__all__ = ["open_network", "read_largest_torques", "read_velocity_range"]


def open_network(path: Path) -> Any:
    """A session of onnxruntime on one thread.

    Raises:
        MissingExtraError: onnxruntime is not installed.
        ModelFileError: The file is no friction network.
    """
    try:
        import onnxruntime
    except ImportError:
        raise MissingExtraError("onnxruntime", "onnx") from None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.execution_mode = onnxruntime.ExecutionMode.ORT_SEQUENTIAL
    options.log_severity_level = 3
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # the runtime raises its own kinds, and bare ones
        raise ModelFileError(f"cannot read the network {path}: {error}") from error
    shapes = [tuple(item.shape[1:]) for item in (*session.get_inputs(), *session.get_outputs())]
    if [item.name for item in session.get_inputs()] != ["state"] or shapes != [(2,), (1,)]:
        raise ModelFileError(f"{path} is no friction network: it must take `state` (n, 2) and give `torque` (n, 1)")
    return session


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
    low, high = (_number(word) for word in words)
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
    largest = np.array([_number(word) for word in words])
    if not np.all(largest > 0.0) or (len(words) == 1 and not np.isfinite(largest[0])):
        raise ModelFileError(
            f"the network's file states {about['largest_torque']!r} as the largest torque measured: it must be finite "
            "and positive; export it anew"
        )
    return largest


def _number(word: str) -> float:
    """What a word of a file means; NaN where it is no number."""
    try:
        return float(word)
    except ValueError:
        return math.nan
