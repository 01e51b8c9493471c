"""Threads for what lets go of the interpreter: started once, since a start costs as much as a short simulation."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TypeVar

from .settings import JOINT

_In = TypeVar("_In")
_Out = TypeVar("_Out")


def run_in_threads(function: Callable[[_In], _Out], items: Iterable[_In]) -> list[_Out]:
    """Call a function with each item, in threads where there are several; the results in their order.

    The function must not ask for threads itself: it might wait for its own.
    """
    each = list(items)
    if len(each) < 2:
        return [function(one) for one in each]
    return list(_keep_pool().map(function, each))


@cache
def _keep_pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(JOINT.threads, thread_name_prefix="fricomp-joint")


if hasattr(os, "register_at_fork"):  # a forked process has the pool, and none of its threads
    os.register_at_fork(after_in_child=_keep_pool.cache_clear)
