"""The command line: a table of commands, and what they share: errors, Ctrl-C, the version.

One command a module, `fricomp/cli/<command>.py` (`check-loop` in `check_loop.py`), named in `COMMANDS`. The
module has a `typer.Typer` called `app`, with one command or a group of them, and is imported only when the
command is used; what is heavy is imported inside the functions.

- A `FricompError` becomes one sentence on stderr and exit status 2; so do a file that cannot be written and a
  package that is not installed. Commands do not catch them.
- Ctrl-C ends with status 130 and a sentence (`fricomp.cli.output.say_interrupted`). A command that moves a joint stops
  it on the way (`with adapter:` does), and lets `KeyboardInterrupt` go on.
- Examples stand in the `epilog` of a command, one a paragraph.
"""

import errno
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from fricomp.cli.lazy import lazy_app
from fricomp.errors import FricompError, MissingExtraError
from fricomp.extras import extra_for
from fricomp.reading import watch_reading
from fricomp.version import __version__

__all__ = ["COMMANDS", "app", "run"]

COMMANDS = {
    "calibrate": "Sweep a joint, identify its friction, and write model, network and report.",
    "identify": "Identify friction from a recording or a table of velocity and torque.",
    "convert": "Bring recordings of other formats into the native one.",
    "diagnose": "Find the physics that a simulation leaves out, in recordings of the real joint.",
    "evaluate": "Measure the torque and position errors of a model over a recording.",
    "compare": "Compare two friction models: what has changed, and whether it matters.",
    "watch": "Follow joints over many models: trends with intervals, what has changed and when.",
    "run": "Compensate friction on a joint, in real time.",
    "check-loop": "Check a compensator in its loop before it runs on a drive.",
    "export": "Write a model as C, ONNX, MJCF, URDF, JSON, or settings of simulators and ROS 2.",
    "adapters": "List the adapters: buses and drives.",
    "adapter": "Try a real drive, carefully, and say what was found.",
    "twin": "Start a drive twin: a simulated drive behind a real protocol.",
    "cases": "Make and list the concealed cases of the diagnosis.",
    "bench": "Benchmarks: every figure of the documentation, measured again.",
}
"""Command to the line that `fricomp --help` shows; each lives in `fricomp/cli/<command>.py`."""

EXIT_ERROR = 2
EXIT_INTERRUPTED = 130

_usual_format = warnings.formatwarning
# A write into a file that is open already says no file name.
_OF_THE_DISK = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)

app = lazy_app(
    "fricomp.cli",
    COMMANDS,
    help="Joint friction: calibrate it, compensate it in real time, find the physics a simulation leaves out.",
    epilog="Begin with [bold]fricomp calibrate --backend sim --out runs/demo[/bold]: no hardware is needed.",
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"fricomp {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Joint friction: calibrate it, compensate it in real time, find the physics a simulation leaves out."""


def run() -> None:
    """Entry point of `fricomp`; exits with 0, 2 (error), 130 (interrupted), or 1.

    1 means that everything was done and the answer is no: `identify`, `calibrate` (not usable), `diagnose` (bad
    data), `check-loop` (not safe), `adapter check` (a step failed), `bench adapters` (a target was missed).
    """
    warnings.formatwarning = _format_warning
    try:
        with watch_reading(_show_reading):
            app()
    except KeyboardInterrupt:  # before a command began; click ends those that had
        print("\nInterrupted.", file=sys.stderr)
        sys.exit(EXIT_INTERRUPTED)
    except (FricompError, ImportError) as error:
        if _was_import_interrupted(error):
            print("\nInterrupted.", file=sys.stderr)
            sys.exit(EXIT_INTERRUPTED)
        if isinstance(error, FricompError):
            _fail(str(error))
        missing = error.name or "" if isinstance(error, ModuleNotFoundError) else ""
        extra = extra_for(missing)
        if extra is None:
            raise
        _fail(str(MissingExtraError(missing, extra)))
    except OSError as error:
        if error.filename is not None:
            _fail(f"{error.filename}: {error.strerror}")
        if error.errno not in _OF_THE_DISK:
            raise
        _fail(f"a file could not be written: {error.strerror}")


def _was_import_interrupted(error: BaseException | None) -> bool:
    """Whether Ctrl-C came while a package was imported, which then says that it cannot be."""
    while error is not None:
        beneath = error.__cause__ or error.__context__
        if isinstance(error, ImportError) and isinstance(beneath, KeyboardInterrupt):
            return True
        error = beneath
    return False


def _format_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, line: str | None = None
) -> str:
    """A warning of this package as a sentence; others with the place in the code that they are from."""
    if category.__module__.startswith("fricomp."):
        return f"{message}\n"
    return _usual_format(message, category, filename, lineno, line)


@contextmanager
def _show_reading(name: str) -> Iterator[Callable[[float], None]]:
    """A bar for each large file that is read."""
    from fricomp.cli.terminal import progress

    with progress() as bar:
        task = bar.add_task(f"reading {name}", total=1.0)
        yield lambda share: bar.update(task, completed=share)


def _fail(message: str) -> None:
    from fricomp.cli.terminal import plain

    print(f"fricomp: {plain(message)}", file=sys.stderr)
    sys.exit(EXIT_ERROR)


if __name__ == "__main__":
    run()
