"""Compensation by networks: one ONNX graph for all joints, bound to fixed buffers, one thread, warmed up."""

import math
import os
import time
from collections.abc import MutableSequence, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.control.compensation.network_file import (
    open_network,
    read_largest_torques,
    read_loads,
    read_velocity_range,
)
from fricomp.control.compensation.trust import LARGEST_EXTRAPOLATION, find_doubt_in_status
from fricomp.errors import ModelFileError, ParameterError
from fricomp.laws import FloatArray

_WARM_UP, _TIMED = 200, 1000
_SAMPLES, _LOADS = 101, 5
_LARGEST_INPUT = float(np.finfo(np.float32).max)


class NetworkCompensator:
    """Friction compensation from the networks that a calibration exports.

    Close to rest the torque is faded with tanh(v/smoothing), outside the trained range of velocity it goes to zero.
    Normal loads beyond the range that the file states for a joint count as its ends.

    Attributes:
        n_joints: Joints of the graph.
        authority: Largest compensation of each joint, from its network over its ranges of velocity and load.
        tail: Slowest of 1000 timed calls but one [s].
        rejected: Inputs so far that were not finite in single precision and got zeros.

    Args:
        path: `friction.onnx` of one joint, or several stacked by `fricomp export`.
        period: Control period [s].
        gain: Share of the friction that is compensated [1].
        smoothing: Velocity over which the direction changes [rad/s] or [m/s].
        velocity_range: Range of validity, the same for all joints; None to take it from the file.
        largest_share: Share of the period that the slowest call may take [1].
        any_status: Take a network too whose model its identification calls unusable.

    Raises:
        MissingExtraError: onnxruntime is not installed.
        ModelFileError: The file is no friction network, or what it says of its ranges or largest torque cannot be
            meant.
        ParameterError: Its calls are too slow for the period, its model is not usable, or an argument is outside its
            domain.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        period: float = 1e-3,
        gain: float = 0.95,
        smoothing: float = 0.005,
        velocity_range: tuple[float, float] | None = None,
        largest_share: float = 0.5,
        any_status: bool = False,
    ) -> None:
        if not 0.0 <= gain <= 2.0 or not smoothing > 0.0:
            raise ParameterError(f"gain must lie from 0 to 2 and smoothing be positive, got {gain!r} and {smoothing!r}")
        self._session = open_network(Path(path))
        about = self._session.get_modelmeta().custom_metadata_map
        doubt = find_doubt_in_status(about.get("status", ""), about.get("message", ""))
        if doubt is not None and not any_status:
            raise ParameterError(
                f"the network {path} is of a model that is not usable ({doubt}); identify it from better data, or pass "
                "any_status=True to use it all the same"
            )
        rows = self._session.get_inputs()[0].shape[0]
        self.n_joints = rows if isinstance(rows, int) else 1
        self._state = np.zeros((self.n_joints, 2), dtype=np.float32)
        self._loads = read_loads(about, self.n_joints)
        self._state[:, 1] = [loads.usual for loads in self._loads]
        self._torque = np.zeros((self.n_joints, 1), dtype=np.float32)
        # Views that read and write plain floats, several times faster than numpy scalars.
        self._states, self._torques = _view_plainly(self._state), _view_plainly(self._torque)
        self._indices = range(self.n_joints)
        self._run = _bind_session(self._session, self._state, self._torque)
        self._gain, self._smoothing, self.rejected = gain, smoothing, 0
        self._range = read_velocity_range(velocity_range, about)
        caps = LARGEST_EXTRAPOLATION * read_largest_torques(about, self.n_joints)
        self.authority: list[float] = np.minimum(self._find_largest(), caps).tolist()
        self.tail = self._measure_tail()
        if self.tail > largest_share * period:
            raise ParameterError(
                f"the slowest calls of this network take {self.tail * 1e6:.0f} µs, over {largest_share:.0%} of the "
                f"period of {period * 1e6:.0f} µs: use the closed form (friction.json), or a longer period"
            )

    def torque_into(
        self,
        out: MutableSequence[float],
        velocity_reference: Sequence[float],
        normal_load: Sequence[float] | None = None,
    ) -> None:
        """Fill `out` with the compensation of each joint.

        Args:
            out: One entry a joint, in the models' torque units.
            velocity_reference: [rad/s] or [m/s].
            normal_load: Those of the last call where None, at first the reference load that the file states, else the
                middle of its range, else 1.
        """
        try:
            usable = _is_finite_in_single(velocity_reference) and (
                normal_load is None or _is_finite_in_single(normal_load)
            )
            if usable:
                self._set_state(velocity_reference, normal_load)
        except (TypeError, ValueError, OverflowError):
            usable = False
        if not usable:
            self.rejected += 1
            out[:] = [0.0] * self.n_joints
            return
        self._run()
        gain, smoothing, (low, high) = self._gain, self._smoothing, self._range
        torque, authority = self._torques, self.authority
        for j in self._indices:
            v = velocity_reference[j]
            size = v if v >= 0.0 else -v
            value = gain * torque[j] * math.tanh(size / smoothing)
            if not low <= v <= high:
                value *= max(0.0, 1.0 - 2.0 * (v - high if v > high else low - v) / (high - low))
            limit = authority[j]
            out[j] = limit if value > limit else -limit if value < -limit else value if value == value else 0.0

    def _set_state(self, velocity_reference: Sequence[float], normal_load: Sequence[float] | None) -> None:
        """Velocities, no closer to rest than the smoothing, and loads.

        Raises:
            ValueError: They are those of another number of joints.
        """
        state, smoothing = self._states, self._smoothing
        if len(velocity_reference) != self.n_joints or (normal_load is not None and len(normal_load) != self.n_joints):
            raise ValueError
        for j in self._indices:
            v = velocity_reference[j]
            if -smoothing <= v <= smoothing:
                v = smoothing if v >= 0.0 else -smoothing
            state[2 * j] = v
            if normal_load is not None:
                low, high, _ = self._loads[j]
                state[2 * j + 1] = min(max(normal_load[j], low), high)

    def run_graph(self) -> None:
        """Run the graph on the inputs of the last call."""
        self._run()

    def _find_largest(self) -> FloatArray:
        """Largest torque of each network over the ranges, from the slowest speed it is asked. Shape (n_joints,)."""
        found, usual = np.zeros(self.n_joints), self._state[:, 1].copy()
        known = np.array([(low, high) if math.isfinite(low) else (at, at) for low, high, at in self._loads])
        slowest = np.clip([-self._smoothing, self._smoothing], *self._range)
        for loads in np.linspace(known[:, 0], known[:, 1], _LOADS):
            self._state[:, 1] = loads
            for v in (*np.linspace(*self._range, _SAMPLES), *slowest):
                self._state[:, 0] = v
                self._run()
                found = np.maximum(found, np.abs(self._torque[:, 0]))
        self._state[:, 1] = usual
        if not np.all(np.isfinite(found)) or not np.all(found > 0.0):
            raise ModelFileError(f"the network gives {found.tolist()} as its largest torques: it is damaged")
        return found

    def _measure_tail(self) -> float:
        for _ in range(_WARM_UP):
            self._run()
        took = []
        for _ in range(_TIMED):
            start = time.perf_counter()
            self._run()
            took.append(time.perf_counter() - start)
        return sorted(took)[-2]


def _is_finite_in_single(values: Sequence[float]) -> bool:
    """Whether all are finite in single precision too."""
    return math.isfinite(sum(values)) and min(values) >= -_LARGEST_INPUT and max(values) <= _LARGEST_INPUT


def _view_plainly(array: Any) -> Any:
    return memoryview(array.ravel())


def _bind_session(session: Any, state: Any, torque: Any) -> Any:
    binding = session.io_binding()
    binding.bind_input("state", "cpu", 0, np.float32, state.shape, state.ctypes.data)
    binding.bind_output(session.get_outputs()[0].name, "cpu", 0, np.float32, torque.shape, torque.ctypes.data)
    run = session.run_with_iobinding
    return lambda: run(binding)
