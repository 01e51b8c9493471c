"""How far the reading of a large file is, told to whoever watches: a command does, a call of the library does not.

What reads stands several calls below what shows a bar, so the watcher is set once for all that is called within.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar

ReadingWatcher = Callable[[str], AbstractContextManager[Callable[[float], None]]]
"""Given the name of a file, a context whose value is called with the share that is read [0 to 1]."""


@contextmanager
def _watch_nothing(name: str) -> Iterator[Callable[[float], None]]:
    yield lambda share: None


_WATCHER: ContextVar[ReadingWatcher] = ContextVar("reading_watcher", default=_watch_nothing)


@contextmanager
def watch_reading(watcher: ReadingWatcher) -> Iterator[None]:
    """Let `watcher` be told of every large file that is read within."""
    token = _WATCHER.set(watcher)
    try:
        yield
    finally:
        _WATCHER.reset(token)


def tell_reading(name: str) -> AbstractContextManager[Callable[[float], None]]:
    """A context in which a file is read, and whom to tell how far."""
    return _WATCHER.get()(name)
