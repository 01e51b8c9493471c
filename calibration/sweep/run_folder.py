"""The folder of one run: what was asked for, what was recorded, how far it came; a kill does it no harm."""

import os
import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Self

import msgspec

from fricomp.errors import OutputError, ParameterError, RecordingError, SweepAborted
from fricomp.folder_lock import FolderLock
from fricomp.recording import RecordingMetadata, RecordingWriter
from fricomp.result_kinds import CALIBRATION
from fricomp.results import make_folder, require_free
from fricomp.untrusted import parse_json, read_whole
from fricomp.version import __version__
from fricomp.whole_file import remove_abandoned_parts, write_whole

from .analysis.block import SweepData, load_sweep
from .request import CalibrationRequest

__all__ = ["MOTION_ALONE", "RECORDING", "RunFolder"]

SCHEMA = "fricomp.run/1"
_REQUEST, RECORDING, MOTION_ALONE = "run.json", "recording.csv", "motion-alone.csv"
"""Files of a run: what was asked for, all that was recorded, and a motion of the user's own without the torque sensor's
zero and the check of signs, as a diagnosis takes no recording with gaps in time."""

_PACKAGES = ("numpy", "scipy", "torch", "mujoco", "onnx", "msgspec")
_MADE_OF_IT = tuple(name for name in CALIBRATION.files if name not in (_REQUEST, RECORDING))
"""Files beside the recording; left there, they would pass for what a run that was interrupted has found."""


class _Run(msgspec.Struct):
    """What stands in run.json."""

    schema: str
    status: str
    created: str
    request: CalibrationRequest
    versions: dict[str, str]
    results: dict[str, Any] = {}


class RunFolder:
    """A run's folder: `run.json`, `recording.csv`, and what is made of them. See `create` and `resume`.

    It is locked against other processes as long as this value or another one of the same folder is there.
    """

    def __init__(self, path: Path, run: _Run) -> None:
        self.path, self._run = path, run
        self._lock = FolderLock.take(path)
        self._lock.note(CALIBRATION.kind)
        remove_abandoned_parts(path)

    @classmethod
    def create(cls, path: str | os.PathLike[str], request: CalibrationRequest, *, overwrite: bool = False) -> Self:
        """Begin a run in a folder, which is made if absent.

        Args:
            path: The folder.
            request: What was asked for.
            overwrite: Throw away the recording of an earlier run there, and the model, network and report made of it.

        Raises:
            SweepAborted: The folder holds a run already.
            OutputError: It cannot be written, holds files of somebody else, or another process writes there.
            ParameterError: It cannot be made.
            RecordingError: What it holds is no recording.
        """
        make_folder(Path(path))
        folder = cls(Path(path), _Run(SCHEMA, "started", _format_now(), request, _collect_versions()))
        require_free(folder.path, CALIBRATION, overwrite=True)
        if not overwrite and folder.recording.exists() and _is_worth_keeping(folder.recording):
            go_on = "" if request.motion else "go on with it (--resume), "
            raise SweepAborted(
                f"{folder.path} holds a run already: {go_on}replace it (--overwrite), or choose another folder (--out)"
            )
        for name in _MADE_OF_IT if overwrite else ():  # of an earlier run
            (folder.path / name).unlink(missing_ok=True)
        folder.recording.unlink(missing_ok=True)
        folder._save()
        return folder

    @classmethod
    def resume(cls, path: str | os.PathLike[str], changes: Mapping[str, Any] | None = None) -> Self:
        """Go on with a run that was interrupted, as it was asked for.

        Args:
            path: The folder.
            changes: What is asked for otherwise now: `normal_load`, `method`, `noise`.

        Raises:
            SweepAborted: There is none.
            OutputError: Another process writes there.
            RecordingError: Its `run.json` is damaged, or asks for what there is not.
        """
        file = Path(path) / _REQUEST
        try:
            stored = parse_json(read_whole(file))
            require_free(Path(path), CALIBRATION, overwrite=True)
            return cls(Path(path), msgspec.convert(_change(stored, changes or {}), _Run))
        except OutputError:
            raise
        except OSError as error:
            why = f"it holds no {_REQUEST}" if isinstance(error, FileNotFoundError) else error.strerror or error
            raise SweepAborted(f"nothing to resume in {path}: {why}") from error
        except (msgspec.ValidationError, ParameterError) as error:
            raise RecordingError(
                f"{file} does not say what can be done: {error}; --method, --noise and --normal-load may be given anew"
            ) from error
        except msgspec.DecodeError as error:
            raise RecordingError(f"{file} is damaged: {error}") from error

    @property
    def recording(self) -> Path:
        """The recording's file."""
        return self.path / RECORDING

    @property
    def request(self) -> CalibrationRequest:
        """What was asked for."""
        return self._run.request

    @property
    def versions(self) -> dict[str, str]:
        """Of fricomp, Python and the packages used."""
        return self._run.versions

    @property
    def results(self) -> Mapping[str, Any]:
        """Figures noted so far."""
        return self._run.results

    @property
    def is_recorded(self) -> bool:
        """Whether everything that was to be recorded is on disk."""
        return self._run.status in ("recorded", "done")

    @property
    def is_motion(self) -> bool:
        """Whether a motion from a file was recorded here instead of a sweep."""
        return bool(self.request.motion) or bool(self.load_data().of_kind("motion"))

    def open_writer(self, metadata: RecordingMetadata, channels: tuple[str, ...]) -> RecordingWriter:
        """A writer that goes on after what is on disk."""
        return RecordingWriter(self.recording, metadata, channels, resume=self.recording.exists())

    def load_data(self) -> SweepData:
        """What is on disk."""
        return load_sweep(self.recording) if self.recording.exists() else SweepData()

    def note(self, status: str, **results: Any) -> None:
        """Write how far the run has come, and figures of it, into run.json.

        Raises:
            SweepAborted: The file cannot be written.
        """
        self._run.status = status
        self._run.results = {**self._run.results, **results}
        self._save()

    def _save(self) -> None:
        text = msgspec.json.format(msgspec.json.encode(self._run), indent=2)
        write_whole(self.path / _REQUEST, text + b"\n", SweepAborted)


def _is_worth_keeping(recording: Path) -> bool:
    """Whether there is more than a start that failed: a run without a plateau, a breakaway or a motion is none.

    Raises:
        RecordingError: It is no recording of a run.
    """
    data = load_sweep(recording)
    return any(data.of_kind(kind) for kind in ("plateau", "breakaway", "motion"))


def _change(stored: Any, changes: Mapping[str, Any]) -> Any:
    """What stands in a run.json with other options of the identification; anything that is not one stays as it is."""
    request = stored.get("request") if isinstance(stored, dict) else None
    options = request.get("options") if isinstance(request, dict) else None
    if isinstance(options, dict):
        for name, value in changes.items():
            (options if name == "normal_load" else options.setdefault("identification", {}))[name] = value
    return stored


def _format_now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


def _collect_versions() -> dict[str, str]:
    found = {"fricomp": __version__, "python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
