"""What a loop asks of the system: refused or granted it is told, and afterwards all is as the host had it."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import pytest

from fricomp.control import RealTimeOptions
from fricomp.control.loop.real_time import real_time
from fricomp.errors import ParameterError

on_linux = pytest.mark.skipif(sys.platform != "linux", reason="scheduling and locked memory are Linux")
NOTHING = RealTimeOptions(freeze_garbage=False)


@pytest.fixture(autouse=True)
def _garbage_as_before() -> Iterator[None]:
    yield
    gc.unfreeze()
    gc.enable()


def test_what_the_system_refuses_is_said_and_all_is_put_back() -> None:
    with real_time(RealTimeOptions(core=10_000)) as report:
        assert not gc.isenabled()
        assert any("core 10000" in refused for refused in report.refused)
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0


def test_what_the_host_has_frozen_stays_frozen() -> None:
    gc.freeze()
    frozen = gc.get_freeze_count()
    gc.disable()
    with real_time(RealTimeOptions()):
        assert not gc.isenabled()
    assert gc.get_freeze_count() == pytest.approx(frozen, abs=100)
    assert not gc.isenabled()


class FakeSystem:
    """The C library, with a timer slack and locked memory of its own."""

    def __init__(self) -> None:
        self.slack, self.calls = 123_456, list[str]()

    def prctl(self, what: int, value: int, *_: int) -> int:
        if what == 30:
            return self.slack
        self.slack = value
        return 0

    def mlockall(self, _: int) -> int:
        self.calls.append("lock")
        return 0

    def munlockall(self) -> int:
        self.calls.append("unlock")
        return 0


@pytest.fixture
def system(monkeypatch: pytest.MonkeyPatch) -> FakeSystem:
    made = FakeSystem()
    monkeypatch.setattr(ctypes, "CDLL", lambda *_, **__: made)
    return made


@on_linux
def test_the_timer_slack_of_the_host_comes_back(system: FakeSystem) -> None:
    with real_time(NOTHING):
        assert system.slack == 1
    assert system.slack == 123_456


@on_linux
@pytest.mark.parametrize(("was_locked", "calls"), [(False, ["lock", "unlock"]), (True, ["lock"])])
def test_memory_that_the_host_has_locked_stays_locked(
    was_locked: bool, calls: list[str], system: FakeSystem, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(import_module("fricomp.control.loop.real_time"), "_is_memory_locked", lambda: was_locked)
    with real_time(RealTimeOptions(lock_memory=True, freeze_garbage=False)):
        pass
    assert system.calls == calls


@on_linux
def test_the_scheduling_of_the_host_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    now: list[Any] = [(os.SCHED_FIFO, 10)]
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: now[-1][0])
    monkeypatch.setattr(os, "sched_getparam", lambda _: os.sched_param(now[-1][1]))
    monkeypatch.setattr(os, "sched_setscheduler", lambda _, policy, p: now.append((policy, p.sched_priority)))
    with real_time(RealTimeOptions(priority=20, freeze_garbage=False)):
        assert now[-1] == (os.SCHED_FIFO, 20)
    assert now[-1] == (os.SCHED_FIFO, 10)


@pytest.mark.parametrize("wrong", [{"core": -1}, {"priority": -1}, {"priority": 100}])
def test_options_that_no_system_knows_are_refused(wrong: dict[str, int]) -> None:
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        RealTimeOptions(**wrong)  # type: ignore[arg-type]
