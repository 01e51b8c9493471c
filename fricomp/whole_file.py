"""Files that appear whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fricomp.errors import FricompError

__all__ = ["whole_file"]


@contextmanager
def whole_file(path: Path, error: type[FricompError]) -> Iterator[Path]:
    """Give a path beside the wanted one to write to; move it into place only when all went well.

    The folder is made where it is not there.

    Args:
        path: Of the file.
        error: What is raised where the folder cannot be made or written, or the disk is full.

    Raises:
        FricompError: Of that kind.
    """
    temporary = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as failure:
        raise error(f"cannot make the folder {path.parent}: {failure.strerror or failure}") from failure
    try:
        yield temporary
        temporary.replace(path)
    except OSError as failure:
        temporary.unlink(missing_ok=True)
        raise error(f"cannot write {path}: {failure.strerror or failure}") from failure
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
