"""What each command writes into a folder: the names of the files, and the record that tells the kind."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from fricomp.untrusted import parse_json, read_whole


@dataclass(frozen=True)
class Results:
    """What a command writes into a folder.

    Attributes:
        kind: What it is, with its article: "a calibration".
        files: Names of all files and folders that it may write, as patterns.
        record: The file among them that says that all are of this kind; empty where none does.
        schema: How the `schema` in the record begins; empty where it has none.
    """

    kind: str
    files: tuple[str, ...]
    record: str = ""
    schema: str = ""

    def are_in(self, folder: Path) -> bool:
        """Whether the folder holds results of this kind, be they of another version or damaged otherwise."""
        if not self.record:
            return False
        path = folder / self.record
        if not self.schema:
            return path.exists()
        try:
            content: Any = parse_json(read_whole(path))
        except (OSError, msgspec.MsgspecError):
            return False
        return isinstance(content, dict) and str(content.get("schema")).startswith(self.schema)

    def list_files(self, folder: Path) -> tuple[str, ...]:
        """What results in a folder have or will have; a motion that was recorded alone has no model."""
        if self is CALIBRATION and re.search(rb'"motion":\s*"[^"]', read_whole(folder / self.record)):
            return CALIBRATION.files[:3]
        return self.files


CALIBRATION = Results(
    "a calibration",
    ("run.json", "recording.csv", "motion-alone.csv", "friction.json", "friction.onnx", "report.html",
     "friction-curve.png", "acquisition.png", "residuals.png", "correlation.png", "training.png"),
    "run.json", "fricomp.run/",
)  # fmt: skip
DIAGNOSIS = Results(
    "a diagnosis",
    ("diagnosis.json", "friction.json", "friction.onnx", "friction.xml", "held_out.json", "report.html", "motion.csv",
     "torque-error.png",
     "over-time-[0-9]*.png", "where.png", "planes.png", "orders.png", "rivals.png",
     "distinguishability.png", "motion.png"),
    "diagnosis.json", "fricomp.diagnosis/",
)  # fmt: skip
IDENTIFICATION = Results(
    "an identification",
    ("friction.json", "friction.onnx", "friction_departed.onnx", "report.html", "friction-curve.png", "residuals.png",
     "training.png"),
)  # fmt: skip
RUN = Results(
    "a run",
    (
        "without_compensation_*.csv", "with_compensation_*.csv", "run-*.png", "timing.png", "figures.json",
        "run.html",
    ),
    "run.html",
)  # fmt: skip
ARM = Results(
    "an arm", ("arm.json", "arm.xml", "report.html", "errors.png", "residuals.png", "joints"),
    "arm.json", "fricomp.arm/",
)  # fmt: skip
EXCITATION = Results(
    "a recorded motion of an arm", ("excitation.json", "excitation.png", "recordings"),
    "excitation.json", "fricomp.excitation/",
)  # fmt: skip
ARM_CASE = Results("a case of an arm", ("arm.xml", "log"))
CASE = Results("a case", ("recording.parquet", "joint.xml", "loop.toml", "friction.json"))
INJECTED_CASE = Results("a recording with an effect put into it", ("recording.parquet", "recording_[0-9]*.parquet"))
FLEET = Results("a fleet of joints", ("fleet.json", "fleet.parquet", "fleet.html", "rows"), "fleet.json")
FIGURES = Results("figures of a benchmark", ("figures.json", "report.html", "*.png", "close_loop"))
TORQUE_CONSTANT = Results(
    "a torque constant", ("torque_constant.json", "bare-*.csv", "loaded-*.csv", "bare.xml", "loaded.xml"),
    "torque_constant.json",
)  # fmt: skip
RECORDED = (ARM, CALIBRATION, DIAGNOSIS, EXCITATION, FLEET, RUN, TORQUE_CONSTANT)
"""Kinds whose folders tell by a record that they are there."""
