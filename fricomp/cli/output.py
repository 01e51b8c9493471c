"""How a command answers: `--quiet` and `--json` of every command, held in one place.

`with_output_options` gives both to a command that has none of its own. While it runs, `console()` of
`fricomp.cli.terminal` asks here where words go: to the terminal, nowhere (`--quiet`), or into what is kept for a
program (`--json`). A command with an answer of its own prints that; of any other, what it says is the answer.
"""

import inspect
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import wraps
from typing import Any

import typer

from fricomp.cli.option.panel import output_option


@dataclass
class Said:
    """What a command has said so far, and how it is to answer.

    Attributes:
        quiet: Nothing is said but errors and, where it is asked for, JSON.
        as_json: The answer is one JSON value, and nothing else stands on stdout.
        answered: Whether the command has printed an answer of its own.
        interrupted: Whether it has said how it was interrupted.
        sentences: In order.
        tables: Title, columns and rows, in order.
    """

    quiet: bool = False
    as_json: bool = False
    answered: bool = False
    interrupted: bool = False
    sentences: list[str] = field(default_factory=list)
    tables: list[dict[str, Any]] = field(default_factory=list)


_TOLD = ("told",)
"""Arguments of an interruption that was told."""
_SAID: ContextVar[Said | None] = ContextVar("said", default=None)


def hearing() -> Said:
    """Of the command that runs now; what nobody hears outside of one."""
    return _SAID.get() or Said()


def with_output_options(command: Any) -> Any:
    """A command, or each of a group, with `--json` and `--quiet`; given once, however often it is asked for."""
    for each in getattr(command, "commands", {}).values():
        with_output_options(each)
    command.help, command.epilog = _join_lines(command.help), _head_examples(_join_lines(command.epilog))
    command.format_help = _whole(command.format_help)
    if hasattr(command, "commands") or any(one.name == "quiet" for one in command.params):
        return command
    # Before --help, which stands last where it is listed.
    command.params = [*command.params, *_make_options()]
    for one in command.params:
        one.help = _keep_brackets(one.help)
    command.callback = _answering(command.callback)
    return command


def _keep_brackets(text: str | None) -> str | None:
    """A text whose units, as in `[s]`, are no markup, which would strike out what follows."""
    return None if text is None else text.replace("[", r"\[")


def _join_lines(text: str | None) -> str | None:
    """A text whose lines end where the terminal does, and not where they do in the source as well."""
    if text is None:
        return None
    return "\n\n".join(" ".join(one.splitlines()) for one in inspect.cleandoc(text).split("\n\n"))


def _head_examples(epilog: str | None) -> str | None:
    """The end of a help with a heading above its examples."""
    return f"[bold]Examples[/bold]\n\n{epilog}" if epilog and epilog.startswith("fricomp ") else epilog


def _whole(format_help: Callable[..., None]) -> Callable[..., None]:
    """Help in which no name of an option is cut."""

    def formatted(*args: Any) -> None:
        from fricomp.cli.help_table import whole_names

        with whole_names():
            format_help(*args)

    return formatted


def _make_options() -> list[Any]:
    """Both options as typer builds them, by whichever version of it is installed."""
    app = typer.Typer(add_completion=False)

    @app.command()
    def options(
        json: bool = output_option(False, "--json", help="Print the answer as JSON, and nothing else on stdout."),
        quiet: bool = output_option(False, "--quiet", "-q", help="Print errors only; with --json, also the JSON."),
    ) -> None:
        pass

    return [one for one in typer.main.get_command(app).params if one.name in ("json", "quiet")]


def _answering(callback: Callable[..., Any]) -> Callable[..., Any]:
    """The function of a command, which takes both options and prints what was said as JSON where that is the answer."""

    @wraps(callback)
    def call(*args: Any, quiet: bool = False, json: bool = False, **options: Any) -> Any:
        with _noting(Said(quiet, json)) as said:
            try:
                result = callback(*args, **options)
            except typer.Exit:
                _print_said(said)
                raise
            except KeyboardInterrupt as interrupt:
                tell_interrupt(interrupt, is_told=said.interrupted)
                raise
            _print_said(said)
            return result

    return call


@contextmanager
def _noting(said: Said) -> Iterator[Said]:
    token = _SAID.set(said)
    try:
        yield said
    finally:
        _SAID.reset(token)


def _print_said(said: Said) -> None:
    if said.as_json and not said.answered:
        print_json({"sentences": said.sentences, "tables": said.tables})


def say_interrupted(how: str) -> None:
    """Say on stderr that a command was interrupted; one that says nothing of its own has "Interrupted." said of it.

    Args:
        how: What follows that word: what is left, and how to go on.
    """
    hearing().interrupted = True
    print(f"\nInterrupted{how}", file=sys.stderr)


def tell_interrupt(interrupt: KeyboardInterrupt, *, is_told: bool = False) -> None:
    """Say that a command was interrupted, once of each interruption.

    Args:
        interrupt: As it was raised.
        is_told: Whether the command has said it.
    """
    if not is_told and interrupt.args != _TOLD:
        print("\nInterrupted.", file=sys.stderr)
    interrupt.args = _TOLD


def answer(value: Any) -> None:
    """Print the answer of a command where `--json` asks for it; in its place, what the command said would be printed.

    Args:
        value: As of `format_json`.
    """
    if hearing().as_json:
        print_json(value)


def print_json(value: Any) -> None:
    """Print a value as JSON on stdout, as of `format_json`."""
    from fricomp.whole_file import format_json

    hearing().answered = True
    print(format_json(value))
