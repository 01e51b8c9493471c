"""The one rule of every command that writes results: what is there is replaced by `--overwrite` alone.

- A file that is read is never written over.
- A link is never followed, and never replaced: somebody has put it there for a reason.
- Results of another kind, such as a model in the folder of a calibration, are never replaced, not by `--overwrite`.
- Results of the same kind are replaced by `--overwrite`, or where the process that wrote them was killed meanwhile.
- One process writes a folder, or a single file, at a time.
"""

import re
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from fnmatch import fnmatchcase
from pathlib import Path

from fricomp.errors import OutputError, ParameterError
from fricomp.folder_lock import FolderLock
from fricomp.result_kinds import RECORDED, Results
from fricomp.untrusted import find_place
from fricomp.whole_file import remove_abandoned_parts

_LONGEST_NAME = 100  # characters of a joint's name in that of a file
_MOST_SHOWN = 6  # files that a refusal names


def require_folder(folder: Path) -> None:
    """Refuse a path below which nothing can be written, before any work is done.

    Raises:
        ParameterError: It is a file, or lies below one.
    """
    for place in (folder, *folder.parents):
        if place.exists():
            if not place.is_dir():
                raise ParameterError(f"cannot make the folder {folder}: {place} is a file; choose another --out")
            return


def make_folder(folder: Path) -> None:
    """Make a folder with those above it, if it is not there.

    Raises:
        ParameterError: It cannot be made.
    """
    require_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ParameterError(
            f"cannot make the folder {folder}: {error.strerror or error}; choose another --out"
        ) from error


def plain_name(text: str) -> str:
    """A part of a file's name from the name of a joint, which may hold what leads into another folder."""
    return re.sub(r"[^\w.+=@ -]", "_", text)[:_LONGEST_NAME].strip(". ") or "joint"


def find_results(folder: Path, results: Results) -> list[str]:
    """Names in the folder that results of this kind have too, links that lead nowhere among them."""
    try:
        names = sorted(path.name for path in folder.iterdir())
    except FileNotFoundError:
        return []
    except OSError as error:
        raise OutputError(
            f"cannot read the folder {folder}: {error.strerror or error}; choose another --out"
        ) from error
    return [name for name in names if any(fnmatchcase(name, pattern) for pattern in results.files)]


def require_free(
    folder: Path,
    results: Results,
    *,
    overwrite: bool = False,
    inputs: Collection[Path] = (),
    unfinished: bool = False,
) -> None:
    """Refuse a folder in which something would be replaced against the rule of this module.

    Args:
        folder: Where results are to be written; it need not be there.
        results: What is written.
        overwrite: Whether results of the same kind may be replaced.
        inputs: Files that are read.
        unfinished: Whether a process that wrote such results there has not come to their end.

    Raises:
        ParameterError: The folder is a file, or lies below one.
        OutputError: Something is in the way; the message says what, and what to do.
    """
    require_folder(folder)
    _keep_inputs(folder, results, inputs)
    there = find_results(folder, results)
    links = [name for name in there if (folder / name).is_symlink()]
    if links:
        raise OutputError(
            f"{folder} holds the link {links[0]}, which is not followed: remove it, or choose another --out"
        )
    other = next((each for each in RECORDED if each is not results and each.are_in(folder)), None)
    if other is not None and not results.are_in(folder) and set(results.files) & set(other.list_files(folder)):
        raise OutputError(
            f"{folder} holds {other.kind} ({other.record}), and {results.kind} would replace files of it: "
            "choose another --out"
        )
    if unfinished:
        return
    if there and results.record and not results.are_in(folder):
        raise OutputError(
            f"{folder} holds {_names(there)}, which {results.kind} writes too and which comes from something else: "
            "choose another --out, or move it away"
        )
    if there and not overwrite:
        raise OutputError(
            f"{folder} holds {_names(there)} already: replace {'it' if len(there) == 1 else 'them'} (--overwrite), or "
            "choose another --out"
        )


def require_free_file(path: Path, *, overwrite: bool = False, inputs: Collection[Path] = ()) -> None:
    """Refuse one file that would replace another against the rule of this module; what a killed writer left goes.

    Raises:
        OutputError: It is an input, a link, a folder, or there already and not to be replaced.
    """
    if find_place(path) in set(map(find_place, inputs)):
        raise OutputError(f"{path} was read, and would be written over: choose another --out")
    if path.is_symlink():
        raise OutputError(f"{path} is a link, which is not followed: remove it, or choose another --out")
    if path.is_dir():
        raise OutputError(f"{path} is a folder: give the name of a file in it as --out")
    if path.exists() and not overwrite:
        raise OutputError(f"{path} is there already: replace it (--overwrite), or choose another --out")
    remove_abandoned_parts(path.parent)


@contextmanager
def claim_file(path: Path, *, overwrite: bool) -> Iterator[None]:
    """Keep the folder of one file to this process while the file is made; it is made where it is not there.

    Raises:
        ParameterError: The folder cannot be made.
        OutputError: Another process writes there, or the file is not to be replaced. See `require_free_file`.
    """
    require_folder(path.parent)
    made = _make_folders(path.parent)
    try:
        with FolderLock.take(path.parent):
            require_free_file(path, overwrite=overwrite)
            yield
    finally:
        _remove_empty(made)


@contextmanager
def claim_single_files(paths: Collection[Path], *, overwrite: bool, inputs: Collection[Path] = ()) -> Iterator[None]:
    """Keep single files to this process while they are made; their folders, made where they are not there, are shared.

    Raises:
        ParameterError: A folder cannot be made.
        OutputError: Another process writes one of the files or its folder, or one is not to be replaced. See
            `require_free_file`.
    """
    for path in paths:
        require_folder(path.parent)
    made = [_make_folders(path.parent) for path in paths]
    try:
        with ExitStack() as locks:
            for path in paths:
                locks.enter_context(FolderLock.take_file(path))
                require_free_file(path, overwrite=overwrite, inputs=inputs)
            yield
    finally:
        for folders in made:
            _remove_empty(folders)


class Claim:
    """A folder of results that this process alone writes. See `claim_folder`.

    Attributes:
        folder: Where it is.
        is_repeated: Whether a process that wrote such results there was ended before it had finished them.
    """

    def __init__(self, folder: Path, results: Results, inputs: Collection[Path], *, is_repeated: bool = False) -> None:
        self.folder, self._results, self.is_repeated = folder, results, is_repeated
        self._inputs = set(map(find_place, inputs))

    def clear(self) -> None:
        """Remove what earlier results of the kind left; to be called when the new ones are about to be written.

        Raises:
            OutputError: A file cannot be removed.
        """
        for name in find_results(self.folder, self._results):
            path = self.folder / name
            if path.is_dir() or find_place(path) in self._inputs:
                continue
            try:
                path.unlink(missing_ok=True)
            except OSError as error:
                raise OutputError(f"cannot replace {path}: {error.strerror or error}; choose another --out") from error


@contextmanager
def claim_folder(
    folder: Path, results: Results, *, overwrite: bool = False, inputs: Collection[Path] = ()
) -> Iterator[Claim]:
    """Keep a folder to this process while its results are made and written; it is made where it is not there.

    Args:
        folder: Where results are written.
        results: What is written.
        overwrite: Whether results of the same kind may be replaced.
        inputs: Files that are read.

    Raises:
        ParameterError: The folder cannot be made.
        OutputError: Another process writes there, or something would be replaced against the rule of this module.
    """
    require_folder(folder)
    made = _make_folders(folder)
    try:
        lock = FolderLock.take(folder)
        try:
            unfinished = lock.left is not None and lock.left.writes == results.kind
            require_free(folder, results, overwrite=overwrite, inputs=inputs, unfinished=unfinished)
            remove_abandoned_parts(folder)
            lock.note(results.kind)
            yield from _watch(Claim(folder, results, inputs, is_repeated=unfinished), lock)
        finally:
            lock.release()
    finally:
        _remove_empty(made)


def _watch(claim: Claim, lock: FolderLock) -> Iterator[Claim]:
    """Give the claim; where results are begun and not finished, leave the lock file as the sign of it."""
    before = _state(claim)
    try:
        yield claim
    except BaseException:
        if _state(claim) != before:
            lock.abandon()
        raise


def _state(claim: Claim) -> dict[str, int]:
    """Time of the last change of each result that is there [ns]."""
    folder = claim.folder
    return {name: (folder / name).lstat().st_mtime_ns for name in find_results(folder, claim._results)}


def _make_folders(folder: Path) -> list[Path]:
    """Make a folder; gives those that were not there before, the innermost first."""
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    make_folder(folder)
    return missing


def _remove_empty(folders: list[Path]) -> None:
    """Remove folders in which nothing was written."""
    for folder in folders:
        with suppress(OSError):
            folder.rmdir()


def _keep_inputs(folder: Path, results: Results, inputs: Collection[Path]) -> None:
    for path in inputs:
        place = find_place(path)
        if place.parent == find_place(folder) and any(fnmatchcase(place.name, pattern) for pattern in results.files):
            raise OutputError(f"{results.kind} into {folder} would write over its input {path}: choose another --out")


def _names(names: list[str]) -> str:
    shown = ", ".join(names[:_MOST_SHOWN])
    return shown if len(names) <= _MOST_SHOWN else f"{shown} and {len(names) - _MOST_SHOWN} more"
