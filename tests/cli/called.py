"""`fricomp` as its entry point runs it, in this process: no interpreter is started and no module loaded again."""

from __future__ import annotations

import io
import sys
from contextlib import redirect_stderr, redirect_stdout
from subprocess import CompletedProcess
from unittest.mock import patch

from fricomp.cli.main import run

__all__ = ["call"]


def call(*arguments: object) -> CompletedProcess[str]:
    """What the command with these arguments writes to both streams, and the status that it ends with.

    Args:
        arguments: After `fricomp` on the command line.
    """
    command, status = ["fricomp", *map(str, arguments)], 0
    told, complained = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
    with patch.object(sys, "argv", command), redirect_stdout(told), redirect_stderr(complained):
        try:
            run()
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else int(end.code is not None)
    texts = [stream.buffer.getvalue().decode() for stream in (told, complained)]
    return CompletedProcess(command, status, *texts)
