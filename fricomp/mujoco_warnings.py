"""Simulations that may run away, without MuJoCo's warnings.

MuJoCo prints a warning for each simulation that becomes unstable, and adds it to a file `MUJOCO_LOG.TXT` where the
command was called. A model that explains a recording badly does become unstable; the error that is printed says so.
"""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def silence_mujoco() -> Iterator[None]:
    """Drop what MuJoCo warns of; a handler of the caller's is back afterwards.

    Raises:
        ImportError: MuJoCo is not installed.
    """
    import mujoco

    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
