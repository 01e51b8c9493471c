"""Friction as an ONNX graph, taken as a term of a law: what it gives on both sides of rest tells dry from held."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from fricomp.control.compensation.network_file import open_graph
from fricomp.errors import ModelFileError
from fricomp.laws import FloatArray, OperatingPoint, Parts, Term

_NEXT_TO_REST = 1e-6  # [rad/s] or [m/s]
_COLUMNS = ("velocity", "normal_load", "position", "load_torque", "temperature", "acceleration")


class NetworkTerm(Term):
    """A graph of `state` (n, columns) to `torque` (n, 1), as `fricomp export` and `fricomp diagnose` write it.

    Args:
        path: The file. Its columns are velocity, normal load, and as many of position, load torque, temperature and
            acceleration as it has.

    Raises:
        ModelFileError: It is no such graph.
        MissingExtraError: onnxruntime is not installed.
    """

    units: ClassVar[Mapping[str, str]] = {}

    def __init__(self, path: Path) -> None:
        self._session = open_graph(path)
        self._columns = _COLUMNS[: self._session.get_inputs()[0].shape[1]]
        self._unused = self._session.get_modelmeta().custom_metadata_map.get("unused", "")
        object.__setattr__(self, "name", "network")

    def parameters(self) -> dict[str, float]:
        """None: they are the weights."""
        return {}

    def parts(self, point: OperatingPoint) -> Parts:
        """Level of dry friction and what is held, from the torque on both sides of rest."""
        v = np.asarray(point.velocity, dtype=np.float64)
        size = np.maximum(np.abs(v), _NEXT_TO_REST)
        sign = np.where(v >= 0.0, 1.0, -1.0)
        ahead, back = (self._run(point, side * np.full_like(size, _NEXT_TO_REST)) for side in (1.0, -1.0))
        held = 0.5 * (ahead + back)
        return Parts(held=held, dry=(self._run(point, sign * size) - held) * sign)

    def _run(self, point: OperatingPoint, velocity: FloatArray) -> FloatArray:
        given: dict[str, Any] = {name: getattr(point, name) for name in self._columns} | {"velocity": velocity}
        for name in [name for name, value in given.items() if value is None]:
            if name != "normal_load" and name not in self._unused:
                raise ModelFileError(f"the network needs the {name}, which the recording does not have: record it too")
            given[name] = 1.0
        columns = [np.broadcast_to(np.asarray(given[name], dtype=np.float32), velocity.shape) for name in self._columns]
        state = np.stack(columns, axis=-1).reshape(-1, len(columns))
        torque = np.asarray(self._session.run(None, {"state": state})[0], dtype=np.float64)
        return torque.reshape(velocity.shape)
