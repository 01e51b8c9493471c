"""The folder of a run of a study: one process writes it at a time, and nothing of somebody else's is replaced in it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fricomp.result_kinds import Results
from fricomp.results import claim_folder

_ANYTHING = ("[!.]*",)  # but hidden files: a run has a folder to itself


@contextmanager
def claim_run(out: Path, record: str, *, go_on: bool = True) -> Iterator[None]:
    """Keep a folder to this process and to runs of its kind.

    Args:
        out: The folder; it is made where it is not there.
        record: File or folder in it that says that a run of this kind is there.
        go_on: Whether a run that is there goes on, or is replaced.

    Raises:
        ParameterError: The folder cannot be made.
        OutputError: Another process writes there, something else is there, or a run that is not to go on.
    """
    with claim_folder(out, Results("a run of this study", _ANYTHING, record), overwrite=go_on):
        yield
