"""A log for viewers such as Foxglove, rerun and PlotJuggler: MCAP with JSON messages and their schema."""

import io
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.validity import Samples
from fricomp.whole_file import write_whole

TOPIC = "/joint_states"
"""The only topic: a message a sample, with an object of numbers for each joint."""


def write_mcap(
    path: Path, time: Samples, joints: Mapping[str, Mapping[str, Samples]], units: Mapping[str, Mapping[str, str]]
) -> None:
    """Write samples of joints as one MCAP file, which appears whole or not at all.

    `fricomp convert`, `identify` and `diagnose` read it as the log of these joints.

    Args:
        path: The file.
        time: Of the samples, shape (n_samples,) [s].
        joints: Columns by joint, shape (n_samples,) each; a number that is not finite is `null` in the file.
        units: Unit of each column, by joint.

    Raises:
        MissingExtraError: mcap is not installed.
        RecordingError: The file cannot be written.
    """
    try:
        from mcap.writer import Writer
    except ImportError as error:
        raise MissingExtraError("mcap", "convert") from error
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start(profile="", library="fricomp")
    schema = writer.register_schema("fricomp.JointStates", "jsonschema", json.dumps(_describe(joints, units)).encode())
    channel = writer.register_channel(TOPIC, "json", schema)
    names = [(joint, column) for joint, columns in joints.items() for column in columns]
    table = np.column_stack([np.asarray(joints[joint][column], dtype=np.float64) for joint, column in names])
    finite = np.isfinite(table)
    for row, (at, values, known) in enumerate(zip(time.tolist(), table.tolist(), finite.tolist(), strict=True)):
        message: dict[str, object] = {joint: {} for joint in joints}
        for (joint, column), value, is_known in zip(names, values, known, strict=True):
            message[joint][column] = value if is_known else None  # type: ignore[index]
        stamp = round(at * 1e9)
        content = json.dumps({"time": at, **message}).encode()
        writer.add_message(channel, log_time=stamp, publish_time=stamp, data=content, sequence=row)
    writer.finish()  # type: ignore[no-untyped-call]
    write_whole(path, stream.getvalue(), RecordingError)


def _describe(joints: Mapping[str, Mapping[str, Samples]], units: Mapping[str, Mapping[str, str]]) -> dict[str, object]:
    """The JSON schema of a message, units in the descriptions."""
    told = {
        joint: {
            "type": "object",
            "properties": {
                column: {"type": "number", "description": f"[{units[joint].get(column, '1')}]"} for column in columns
            },
        }
        for joint, columns in joints.items()
    }
    return {"type": "object", "properties": {"time": {"type": "number", "description": "[s]"}, **told}}
