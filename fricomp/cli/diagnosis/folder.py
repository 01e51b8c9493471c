"""What the folder of a diagnosis holds beside one: a model or a page of somebody else stays where it is."""

from collections.abc import Collection
from pathlib import Path

from fricomp.result_kinds import DIAGNOSIS
from fricomp.results import require_free

RECORD = DIAGNOSIS.record
_MODEL = "friction.json"
_REPORT, _SUBTITLE = "report.html", '<p class="subtitle">Diagnosis of '


def check_folder(folder: Path, inputs: Collection[Path]) -> None:
    """Refuse a folder in which another diagnosis of the same joint would write over what is none of its own.

    Args:
        folder: Where the next diagnosis is written.
        inputs: Files that are given to it.

    Raises:
        OutputError: A file that it writes is one of the inputs, or was not written by a diagnosis.
        ParameterError: The folder is a file, or lies below one.
    """
    require_own(folder)
    require_free(folder, DIAGNOSIS, overwrite=True, inputs=inputs)


def require_own(folder: Path) -> None:
    """Refuse a model or a page beside the record of a diagnosis that is none of it.

    Raises:
        OutputError: There is one.
    """
    from fricomp.errors import OutputError

    if not DIAGNOSIS.are_in(folder):
        return
    kept = {_MODEL: _is_of_diagnosis, _REPORT: _is_report}
    foreign = [name for name, is_own in kept.items() if (folder / name).exists() and not is_own(folder / name)]
    if foreign:
        raise OutputError(
            f"{folder} holds {', '.join(foreign)}, which a diagnosis writes too and which comes from something else: "
            "choose another --out, or move it away"
        )


def _is_of_diagnosis(path: Path) -> bool:
    """Whether a model file was written by a diagnosis."""
    from fricomp.errors import FricompError
    from fricomp.model import load_model

    try:
        return load_model(path).provenance.method == "diagnosis"
    except FricompError:
        return False


def _is_report(path: Path) -> bool:
    """Whether a page was written by a diagnosis, as its subtitle says."""
    try:
        return _SUBTITLE in path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
