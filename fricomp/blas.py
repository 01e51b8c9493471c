"""Linear algebra on one thread, where its problems are small.

Matrices of some thousand rows and a few dozen columns: shared among threads, such a product takes as long as these
wait for each other. On two cores the training of a network is 3 to 50 times slower, most where other work keeps the
cores busy.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Hold numpy's and scipy's linear algebra to one thread; does nothing where threadpoolctl is not installed."""
    controller = _controller()
    if controller is None:
        yield
        return
    with controller.limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> Any:
    """The libraries loaded, looked up once: that takes milliseconds, setting them takes microseconds."""
    try:
        from threadpoolctl import ThreadpoolController  # type: ignore[import-untyped]
    except ImportError:
        return None
    import scipy.linalg  # noqa: F401  # its own copy of the library must be loaded to be found

    return ThreadpoolController()
