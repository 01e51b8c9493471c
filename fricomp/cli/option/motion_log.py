"""`--log FILE.mcap` of `run` and `calibrate`: what the joints did, what the model says of it, and what is left."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np

from fricomp.cli.option.panel import output_option
from fricomp.errors import FricompError, ParameterError

if TYPE_CHECKING:
    from fricomp.calibration.sweep import Calibration
    from fricomp.control.loop.loop_log import LoopLog
    from fricomp.laws import FloatArray
    from fricomp.model import FrictionModel
    from fricomp.recording import RecordingMetadata

LogFile = Annotated[
    Path | None,
    output_option(
        "--log", help="Write MCAP for Foxglove, rerun, PlotJuggler: motion, torque, the model's friction, the residual."
    ),
]
_GAP = 1.0
"""Between two runs in one log [s]."""


@contextmanager
def claim_log(path: Path | None, *, overwrite: bool) -> Iterator[None]:
    """Keep the log to this process, and refuse before anything moves what could not be written after it.

    Raises:
        ParameterError: The file would be no MCAP.
        OutputError: It is there already, or another process writes it.
        MissingExtraError: mcap is not installed.
    """
    if path is None:
        yield
        return
    from fricomp.extras import require
    from fricomp.results import claim_single_files

    require("mcap")
    if path.suffix != ".mcap":
        raise ParameterError(f"--log {path}: the log is MCAP, give a name that ends in .mcap")
    with claim_single_files([path], overwrite=overwrite):
        yield


@contextmanager
def log_runs(path: Path | None, models: Sequence[FrictionModel]) -> Iterator[list[LoopLog]]:
    """Take the logs of runs, and write them one after the other however these end; nothing where no log is wanted."""
    runs: list[LoopLog] = []
    try:
        yield runs
    finally:
        moved = [log for log in runs if len(log) > 1]
        if path is not None and moved:
            _write_runs(path, moved, models)


def _write_runs(path: Path, logs: Sequence[LoopLog], models: Sequence[FrictionModel]) -> None:
    from fricomp.recording.mcap_file import write_mcap

    starts = np.cumsum([0.0, *(float(log.time[-1]) + _GAP for log in logs)])
    time = np.concatenate([log.time + start for log, start in zip(logs, starts, strict=False)])
    references = ("position_reference", "velocity_reference")
    names = ("position", "velocity", "torque", "torque_command", *references, "compensation")
    joints = {}
    for number, model in enumerate(models):
        columns = {name: np.concatenate([log.signal(name)[:, number] for log in logs]) for name in names}
        joints[model.joint] = columns | _compare(model, columns["velocity"], columns["torque"])
    write_mcap(path, time, joints, {model.joint: _units(model) for model in models})


def log_calibration(path: Path | None, calibration: Calibration) -> None:
    """Write the whole sweep with the model that it gave; nothing where no log is wanted."""
    if path is None:
        return
    from fricomp.recording.mcap_file import write_mcap

    blocks, model = [samples for _, samples in calibration.data.blocks], calibration.model
    shared = [name for name in blocks[0].channels if all(name in one.channels for one in blocks)]
    columns = {name: np.concatenate([one.channels[name] for one in blocks]) for name in shared}
    time = columns.pop("time")
    torque = columns["torque"] - columns.get("load_torque", 0.0) - calibration.analysis.offset.value
    velocity = columns.get("velocity")
    more = {} if velocity is None else _compare(model, velocity, np.asarray(torque))
    write_mcap(path, time, {model.joint: columns | more}, {model.joint: _units(model)})


def log_unfinished(path: Path | None, recording: Path) -> str:
    """Write what a sweep had recorded when it ended early, which has no model yet; a phrase on it where that was done.

    Args:
        path: The log; None where none is wanted.
        recording: Blocks as the sweep wrote them.
    """
    if path is None or not recording.exists():
        return ""
    from fricomp.recording.file import read_content
    from fricomp.recording.mcap_file import write_mcap

    with suppress(FricompError):  # how the sweep ended is what is told
        samples = read_content(recording).recording
        columns, metadata = dict(samples.channels), samples.metadata
        write_mcap(path, columns.pop("time"), {metadata.joint: columns}, {metadata.joint: _units(metadata)})
        return f", and as a log in {path}"
    return ""


def _compare(model: FrictionModel, velocity: FloatArray, torque: FloatArray) -> dict[str, FloatArray]:
    """Friction of the model at the measured velocity, and the torque less it; nothing of a model that needs more."""
    try:
        friction = np.asarray(model.torque(velocity), dtype=np.float64)
    except FricompError:
        return {}
    return {"model": friction, "residual": torque - friction}


def _units(said: FrictionModel | RecordingMetadata) -> dict[str, str]:
    """Unit of each channel, as a model or a recording states them."""
    torque, position = said.torque_unit, said.position_unit
    of_torque = dict.fromkeys(("torque", "torque_command", "compensation", "model", "residual", "load_torque"), torque)
    of_velocity = dict.fromkeys(("velocity", "velocity_reference"), f"{position}/s")
    return {"position": position, "position_reference": position, "temperature": "°C"} | of_torque | of_velocity
