"""Executors are left at once on Ctrl-C: what waits is never begun."""

from __future__ import annotations

from concurrent.futures import CancelledError, Future
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from fricomp.cli.bench.side_by_side import run_side_by_side
from fricomp.sim_bench.fleet import open_executor

from .working import leave_a_file, wait_for_a_file


def _interrupt(address: str, folder: Path, futures: list[Future[Any]]) -> None:
    with open_executor(address) as (pool, _):
        futures.append(pool.submit(wait_for_a_file, folder / "0", folder / "go"))
        futures.extend(pool.submit(leave_a_file, folder / str(number)) for number in range(1, 9))
        wait_for_a_file(None, folder / "0")
        raise KeyboardInterrupt


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # dask.distributed warns on its own shutdown
@pytest.mark.parametrize("address", ["processes://1", "dask://local:1"])
def test_no_call_begins_after_ctrl_c_and_none_is_waited_for(address: str, tmp_path: Path) -> None:
    if address.startswith("dask"):
        pytest.importorskip("distributed")
    futures: list[Future[Any]] = []
    with pytest.raises(KeyboardInterrupt):
        _interrupt(address, tmp_path, futures)
    (tmp_path / "go").touch()  # until here the first call has been running
    for future in futures:
        with suppress(CancelledError):
            future.result(timeout=60.0)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0", "go"]


def test_ctrl_c_says_where_what_is_finished_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_side_by_side([interrupted], "serial", "calls", tmp_path)
    assert f"Interrupted; what is finished is in {tmp_path}: --resume goes on" in capsys.readouterr().err
