"""Commands in copies of one process that has loaded their modules: a second or two less for each."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

__all__ = ["Ended", "WarmProcess"]

PATIENCE = 300.0  # for a command [s]

_SERVER = """
import atexit, importlib, json, os, signal, sys, time

def run_copy(asked):
    told = os.open(asked["told"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    for stream in (1, 2):
        os.dup2(told, stream)
    status, known = 1, {"__name__": "__main__", "arguments": asked["arguments"]}
    try:
        exec(asked["code"], known)
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        with open(asked["told"] + ".begun", "w") as file:
            json.dump(sorted(sys.modules), file)
        os.replace(asked["told"] + ".begun", asked["told"] + ".modules")  # whole, or a kill in here leaves half of it
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)

def load(path):
    with open(path) as file:
        for name in set(json.load(file)) - set(sys.modules):
            try:
                importlib.import_module(name)
            except Exception:
                pass

def wait(copy, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        ended, status = os.waitpid(copy, os.WNOHANG)
        if ended:
            return status
        time.sleep(0.001)
    os.kill(copy, signal.SIGKILL)
    return os.waitpid(copy, 0)[1]

answers = os.dup(1)
os.dup2(2, 1)
for line in sys.stdin:
    asked = json.loads(line)
    copy = os.fork()
    if copy == 0:
        run_copy(asked)
    status = os.waitstatus_to_exitcode(wait(copy, asked["seconds"]))
    if os.path.exists(asked["told"] + ".modules"):
        load(asked["told"] + ".modules")
    os.write(answers, b"%d\\n" % status)
"""
# The copy is forked before any thread is there: numpy's and torch's own are off, and the server runs no command itself.


@dataclass(frozen=True)
class Ended:
    """What a call came to.

    Attributes:
        returncode: Exit status, or the negative signal that ended it.
        told: All that it wrote to both streams.
    """

    returncode: int
    told: str


class WarmProcess:
    """A process that runs code in copies of itself, and loads for the next ones what the last one has loaded."""

    def __enter__(self) -> Self:
        self._folder = tempfile.TemporaryDirectory()
        environment = os.environ | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
        command = [sys.executable, "-c", _SERVER]
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self._process = subprocess.Popen(command, text=True, env=environment, **pipes)
        return self

    def __exit__(self, *error: object) -> None:
        with self._process:
            assert self._process.stdin is not None
            self._process.stdin.close()
        self._folder.cleanup()

    def call(self, code: str, arguments: Sequence[str], *, seconds: float = PATIENCE) -> Ended:
        """Run code, which finds its `arguments`, to its end.

        Args:
            code: Python.
            arguments: Of it.
            seconds: After which the copy is killed, if it has not ended by then.
        """
        told = Path(self._folder.name) / "told"
        told.write_text("")
        told.with_name("told.modules").unlink(missing_ok=True)
        asked = {"code": code, "arguments": list(arguments), "told": str(told), "seconds": seconds}
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        stdin.write(json.dumps(asked) + "\n")
        stdin.flush()
        return Ended(int(stdout.readline()), told.read_text("utf-8", "replace"))
