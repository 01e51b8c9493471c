"""Executors are what their address says, and are left at once on Ctrl-C: what waits is never begun."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import suppress
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

import pytest

from fricomp.cli.terminal import resumable
from fricomp.errors import DiagnosisError
from fricomp.fleet import executor, open_executor
from fricomp.fleet.executor import SerialExecutor

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
    (tmp_path / "go").touch()  # until here nothing has told the first call to go on
    for future in futures:
        with suppress(CancelledError, BrokenExecutor):
            future.result(timeout=60.0)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0", "go"]


@pytest.mark.slow
def test_workers_end_with_a_command_that_is_killed(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    script = (
        "from pathlib import Path\n"
        "from fricomp.fleet import open_executor\n"
        "from tests.fleet.working import tell_and_wait\n"
        "if __name__ == '__main__':\n"
        "    with open_executor('processes://1') as (pool, _):\n"
        f"        pool.submit(tell_and_wait, Path({str(begun)!r})).result()\n"
    )
    (tmp_path / "fleet.py").write_text(script)
    root = str(Path(__file__).parents[2])
    command = subprocess.Popen([sys.executable, str(tmp_path / "fleet.py")], env={**os.environ, "PYTHONPATH": root})
    wait_for_a_file(None, begun)
    worker = os.pidfd_open(int(begun.read_text()))
    command.kill()
    command.wait()
    assert wait([worker], timeout=30.0) == [worker]
    os.close(worker)


def test_ctrl_c_says_where_what_is_finished_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), resumable(tmp_path), open_executor("serial") as (pool, _):
        pool.submit(interrupted)
    assert f"Interrupted; what is finished is in {tmp_path}: --resume goes on" in capsys.readouterr().err


@pytest.mark.parametrize(
    "address",
    ["processes://abc", "processes://0", "processes://-2", "serial://2", "dask://", "dask://local:x", "dask://local:0"],
)
def test_an_address_that_is_none_is_refused_with_the_valid_ones(address: str) -> None:
    with pytest.raises(DiagnosisError, match=r"unknown executor .*: valid are processes, processes://N, serial, dask"):
        _open(address)


@pytest.mark.parametrize(
    ("address", "workers", "called"),
    [
        ("dask://localhost:8786", None, ("_join_dask", "tcp://localhost:8786")),
        ("dask://10.0.0.2:8786", None, ("_join_dask", "tcp://10.0.0.2:8786")),
        ("dask://tls://host:1?ca=a.pem", None, ("_join_dask", "tls://host:1?ca=a.pem")),
        ("dask://local", None, ("_start_dask", 2)),
        ("dask://local:3", None, ("_start_dask", 3)),
        ("processes://4", None, ("_run_processes", 4)),
        ("processes", 5, ("_run_processes", 5)),
    ],
)
def test_an_address_opens_what_it_says(
    address: str, workers: int | None, called: tuple[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[tuple[str, Any]] = []
    for name in ("_join_dask", "_start_dask", "_run_processes"):

        def note(place: Any, name: str = name) -> Iterator[tuple[Executor, int]]:
            calls.append((name, place))
            yield SerialExecutor(), 1

        monkeypatch.setattr(executor, name, note)
    _open(address, workers)
    assert calls == [called]


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("dask://host:1?ca=a.pem", "certificates are of TLS: write dask://tls://host:port"),
        ("dask://tls://host:1?pem=a.pem", "'pem' is no certificate of TLS: valid are ca, cert, key"),
        ("dask://tls://host:1?ca=/not/there.pem", "cannot read the file '/not/there.pem' that ca of TLS names"),
    ],
)
def test_certificates_that_cannot_be_meant_are_refused(address: str, says: str) -> None:
    pytest.importorskip("distributed")
    with pytest.raises(DiagnosisError, match=says):
        _open(address)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # dask.distributed warns on its own shutdown
def test_a_scheduler_is_reached_by_tls_with_its_certificates_alone(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("no openssl: apt-get install openssl")
    made = [openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost"]
    key, cert = tmp_path / "key.pem", tmp_path / "cert.pem"
    subprocess.run([*made, "-keyout", str(key), "-out", str(cert)], check=True, capture_output=True)
    names = ("tls_ca_file", "tls_client_cert", "tls_worker_cert", "tls_scheduler_cert")
    keys = ("tls_client_key", "tls_worker_key", "tls_scheduler_key")
    files = dict.fromkeys(names, str(cert)) | dict.fromkeys(keys, str(key))
    security = distributed.Security(require_encryption=True, **files)
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None, "security": security}
    with distributed.LocalCluster(**options) as cluster:
        assert cluster.scheduler_address.startswith("tls://")
        address = f"dask://{cluster.scheduler_address}?ca={cert}&cert={cert}&key={key}"
        with open_executor(address) as (pool, workers):
            assert (pool.submit(abs, -3).result(timeout=60.0), workers) == (3, 1)


def test_an_executor_that_counts_its_own_workers_takes_no_number() -> None:
    for address in ("serial", "processes://2", "dask://local:2", "dask://host:1"):
        with pytest.raises(DiagnosisError, match="leave out --workers"):
            _open(address, 3)


def _open(address: str, workers: int | None = None) -> None:
    with open_executor(address, workers):
        pass
