"""The loop that moved the joint: read from a file, or estimated from reference, position and torque."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from scipy.signal import lfilter

from fricomp.errors import DiagnosisError
from fricomp.recording import Recording
from fricomp.untrusted import convert_table, parse_toml, read_whole

from .left_out import fit_without_blocks
from .settings import INPUT
from .signal import FloatArray, differentiate


@dataclass(frozen=True)
class Controller:
    """torque = P (q_ref - q) + D (d v_ref - v) + I ∫(q_ref - q) dt + A a_ref + b.

    Attributes:
        proportional_gain: P [N·m/rad].
        derivative_gain: D [N·m·s/rad].
        integral_gain: I [N·m/(rad·s)].
        reference_share: d, the part of the reference's velocity that D sees: 1 for most loops, 0 where it damps only.
        acceleration_gain: A [kg·m²].
        bias: b [N·m].
        velocity_filter_frequency: Cut-off frequency of the first-order filter on v [Hz]; None without one.
        torque_limit: [N·m]; None without one.
        frequency: Rate at which it answers [Hz]; None where that is not known.
        source: "given" or "estimated".
        explained: Part of the torque's variance that it explains; 1 for one that was given.
    """

    proportional_gain: float
    derivative_gain: float = 0.0
    integral_gain: float = 0.0
    reference_share: float = 1.0
    acceleration_gain: float = 0.0
    bias: float = 0.0
    velocity_filter_frequency: float | None = None
    torque_limit: float | None = None
    frequency: float | None = None
    source: str = "given"
    explained: float = 1.0

    def compute_filter_memory(self, step: float) -> float:
        """What the velocity filter keeps of its state over `step` [s]."""
        return _compute_memory(self.velocity_filter_frequency, step)

    @property
    def kind(self) -> str:
        """P, PD, PI or PID."""
        return "P" + "I" * (self.integral_gain != 0.0) + "D" * (self.derivative_gain != 0.0)

    def describe(self, torque: str, position: str) -> str:
        """Kind and gains in one line, in these units of torque and position."""
        how = f"estimated, explains {self.explained:.1%} of the torque" if self.source == "estimated" else self.source
        return f"{self.kind} controller ({how}): {self.describe_gains(torque, position)}"

    def describe_gains(self, torque: str, position: str) -> str:
        """The gains in one line, in these units of torque and position."""
        parts = [f"proportional {self.proportional_gain:.4g} {torque}/{position}"]
        if self.integral_gain:
            parts.append(f"integral {self.integral_gain:.4g} {torque}/({position}·s)")
        if self.derivative_gain:
            parts.append(f"derivative {self.derivative_gain:.4g} {torque}·s/{position}")
        if self.acceleration_gain:
            parts.append(f"acceleration {self.acceleration_gain:.4g} {torque}·s²/{position}")
        return ", ".join(parts)


class _File(msgspec.Struct, forbid_unknown_fields=True):
    """The table `[controller]`."""

    proportional_gain: float
    derivative_gain: float = 0.0
    integral_gain: float = 0.0
    reference_share: float = 1.0
    acceleration_gain: float = 0.0
    velocity_filter_frequency: float | None = None
    torque_limit: float | None = None
    kind: str = ""
    frequency: Annotated[float, msgspec.Meta(gt=0.0)] | None = None


def read_controller(path: str | Path) -> Controller:
    """Read a controller from TOML, from its table `[controller]` or from the top of the file.

    Raises:
        DiagnosisError: The file cannot be read, or a gain is missing, unknown or not a number.
    """
    try:
        table = parse_toml(read_whole(path).decode("utf-8"))
        found = convert_table(table.get("controller", table), _File)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DiagnosisError(f"cannot read the controller {path}: {error}") from error
    except msgspec.ValidationError as error:
        raise DiagnosisError(f"the controller {path} is no PD or PID loop: {error}") from error
    gains = {name: getattr(found, name) for name in _File.__struct_fields__ if name != "kind"}
    return Controller(**gains)


def estimate_controller(recording: Recording) -> Controller | None:
    """Estimate the PD or PID loop that explains the torque by reference and position; None where no loop does.

    Gains are least squares; one that takes little on blocks that were left out is not in the loop.
    """
    if recording.position_reference is None or len(recording) < 500:
        return None
    torque = read_told_torque(recording)
    found = [_fit_loop(_build_columns(recording, cutoff), torque, cutoff) for cutoff in INPUT.velocity_cutoffs]
    best = max(found, key=lambda one: one.explained)
    stable = best.proportional_gain > 0.0 and best.derivative_gain >= 0.0
    return best if stable and best.explained > INPUT.loop_explains else None


def compute_answer(controller: Controller, recording: Recording) -> FloatArray:
    """Compute the torque that a loop gives along a recording with its reference [N·m], with its integral starting at
    zero.

    Shape (n,), of the samples that gains are estimated from.
    """
    columns, d = _build_columns(recording, controller.velocity_filter_frequency), controller.derivative_gain
    weights = {
        "error": controller.proportional_gain,
        "velocity": d,
        "reference": d * controller.reference_share,
        "integral": controller.integral_gain,
        "acceleration": controller.acceleration_gain,
    }
    wanted: FloatArray = np.sum([weight * columns[name] for name, weight in weights.items()], axis=0) + controller.bias
    limit = controller.torque_limit
    return wanted if limit is None else np.clip(wanted, -limit, limit)


def read_told_torque(recording: Recording) -> FloatArray:
    """Read the torque that a loop commanded, or else the recorded one [N·m], at the samples that gains are estimated
    from."""
    told = recording.torque if recording.torque_command is None else recording.torque_command
    return np.asarray(told)[: INPUT.loop_samples]


def _fit_loop(columns: dict[str, FloatArray], torque: FloatArray, cutoff: float | None) -> Controller:
    """Fit the loop that explains `torque`, and leave out terms that hardly help."""
    chosen = ["error", "velocity", "reference", "integral", "acceleration"]
    left = _compute_unexplained(columns, chosen, torque)
    for name in ("acceleration", "integral", "reference", "velocity"):
        trial = [one for one in chosen if one != name]
        unexplained = _compute_unexplained(columns, trial, torque)
        if unexplained * (1.0 - INPUT.gain_worth) < left and not (name == "velocity" and "reference" in chosen):
            chosen, left = trial, unexplained
    weights = dict(zip([*chosen, "bias"], _fit(columns, chosen, torque), strict=True))
    damping = weights.get("velocity", 0.0)
    return Controller(
        proportional_gain=weights["error"],
        derivative_gain=damping,
        integral_gain=weights.get("integral", 0.0),
        reference_share=weights.get("reference", 0.0) / damping if damping > 0.0 else 1.0,
        acceleration_gain=weights.get("acceleration", 0.0),
        bias=weights["bias"],
        velocity_filter_frequency=cutoff if damping else None,
        source="estimated",
        explained=1.0 - left,
    )


def _compute_memory(cutoff: float | None, step: float) -> float:
    return 0.0 if cutoff is None else float(np.exp(-2.0 * np.pi * cutoff * step))


def _build_columns(recording: Recording, cutoff: float | None) -> dict[str, FloatArray]:
    """Build the signals that the gains of a loop multiply. The velocity is the filtered difference of positions. Shapes
    (n,)."""
    dt = recording.sample_period
    reference, position = np.asarray(recording.position_reference), np.asarray(recording.position)
    error = reference - position
    wanted = recording.velocity_reference
    wanted = np.gradient(reference, dt) if wanted is None else np.asarray(wanted)
    seen = np.diff(position, prepend=position[0]) / dt
    keep = _compute_memory(cutoff, dt)
    seen = lfilter([1.0 - keep], [1.0, -keep], seen)
    columns = {
        "error": error,
        "velocity": -seen,
        "reference": wanted,
        "integral": np.cumsum(error) * dt,
        "acceleration": differentiate(wanted, dt),
    }
    return {name: values[: INPUT.loop_samples] for name, values in columns.items()}


def _build_table(columns: dict[str, FloatArray], names: list[str]) -> FloatArray:
    return np.column_stack([*(columns[name] for name in names), np.ones(columns["error"].size)])


def _fit(columns: dict[str, FloatArray], names: list[str], torque: FloatArray) -> list[float]:
    table = _build_table(columns, names)
    size = np.linalg.norm(table, axis=0) + 1e-30
    return [float(one) for one in np.linalg.lstsq(table / size, torque, rcond=1e-9)[0] / size]


def _compute_unexplained(columns: dict[str, FloatArray], names: list[str], torque: FloatArray) -> float:
    """Compute the part of the torque's variance that is left on blocks which were not fitted."""
    table, error = _build_table(columns, names), np.empty(torque.size)
    size = np.linalg.norm(table, axis=0) + 1e-30
    for part, weights in fit_without_blocks(table / size, torque, INPUT.loop_folds, rcond=1e-9):
        error[part] = torque[part] - table[part] @ (weights / size)
    return float(np.mean(error**2) / max(float(np.var(torque)), 1e-30))
