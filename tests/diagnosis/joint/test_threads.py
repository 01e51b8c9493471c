"""Threads that are kept: results in order, whatever runs first, in a forked process as well."""

import multiprocessing
import sys
import threading

import pytest

from fricomp.diagnosis.joint.threads import run_in_threads


def test_results_come_in_the_order_of_the_items() -> None:
    assert run_in_threads(lambda x: x * x, range(20)) == [x * x for x in range(20)]


def test_threads_are_kept_from_call_to_call_and_a_lone_item_needs_none() -> None:
    names = {run_in_threads(lambda _: threading.current_thread().name, range(4))[0] for _ in range(20)}
    assert len(names) <= 2
    assert run_in_threads(lambda _: threading.current_thread(), [0]) == [threading.current_thread()]


def _square(values: list[int]) -> list[int]:
    return run_in_threads(lambda x: x * x, values)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems start processes anew")
@pytest.mark.filterwarnings("ignore:This process")
def test_a_forked_process_starts_threads_of_its_own() -> None:
    _square([1, 2, 3])
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(_square, ([1, 2, 3],)).get(timeout=20.0) == [1, 4, 9]
