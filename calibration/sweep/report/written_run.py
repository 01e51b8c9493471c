"""What a calibration leaves in its folder beside the recording: model, network, report, pictures and `run.json`."""

from dataclasses import dataclass
from pathlib import Path

from fricomp.report import Check

from ...identification import save_identification
from ..calibrate import Calibration
from ..run_folder import RunFolder
from .check import calibration_checks
from .report import write_calibration_report


@dataclass(frozen=True)
class WrittenRun:
    """What was written, and what was checked.

    Attributes:
        checks: Of the sweep and of the identification.
        files: Model, network, report, recording and `run.json`.
        pictures: Charts of the report as PNG.
    """

    checks: tuple[Check, ...]
    files: tuple[Path, ...]
    pictures: tuple[Path, ...]


def write_run(calibration: Calibration, folder: RunFolder) -> WrittenRun:
    """Write everything that is made of a sweep into its folder, and note there that it is done.

    Raises:
        ModelFileError: The model cannot be written.
        ExportError: The network cannot be written.
        MissingExtraError: plotly, jinja2 or matplotlib is not installed.
    """
    result, checks = calibration.estimate.result, calibration_checks(calibration)
    files = save_identification(result, folder.path)
    facts = {**_collect_facts(folder), "hash of the model": files.model_sha256}
    page, pictures = write_calibration_report(calibration, checks, facts, folder.path)
    folder.note(
        "done",
        parameters=result.parameters,
        standard_deviations=result.standard_deviations,
        identification=str(result.status),
        checks={check.name: f"{check.outcome}: {check.detail}" for check in checks},
        recording_points=len(calibration.analysis.points),
        model_sha256=files.model_sha256,
    )
    written = (files.model, files.network, page, folder.recording, folder.path / "run.json")
    return WrittenRun(checks, written, pictures)


def _collect_facts(folder: RunFolder) -> dict[str, str]:
    request = folder.request
    chosen = {"backend": request.backend, "configuration": str(request.configuration), "model": request.model or "none"}
    settings = {name: str(getattr(request.settings, name)) for name in request.settings.__dataclass_fields__}
    return chosen | settings | {f"version of {name}": version for name, version in folder.versions.items()}
