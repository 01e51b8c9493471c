"""A group of commands whose modules are imported only when one of them is used."""

from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import typer
from typer.core import TyperGroup

from fricomp.cli.help_table import whole_names
from fricomp.cli.output import tell_interrupt, with_output_options

__all__ = ["LazyGroup", "lazy_app"]


class LazyGroup(TyperGroup):
    """Lists placeholders, and puts the real command in place of the one that is called.

    Attributes:
        package: That holds one module a command.
        default: Command that options without a command are meant for; empty for none.
    """

    package: str = ""
    default: str = ""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Help as of any other command."""
        with whole_names():
            super().format_help(ctx, formatter)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Options without a command go to the default one, where there is one."""
        if self.default and args and args[0].startswith("-") and args[0] not in ctx.help_option_names:
            args = [self.default, *args]
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; Ctrl-C that no command has said anything of, as its module is still imported, is told."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            tell_interrupt(interrupt)
            raise

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The real command that `args` begins with; only its module is imported."""
        name, placeholder, rest = super().resolve_command(ctx, args)
        if name is None or placeholder is None:
            return name, placeholder, rest
        module = import_module(module_name(self.package, name))
        command = with_output_options(typer.main.get_command(module.app))
        command.name = name
        return name, command, rest


def module_name(package: str, command: str) -> str:
    """The module of a command: `check-loop` lives in `check_loop`."""
    return f"{package}.{command.replace('-', '_')}"


def lazy_app(
    package: str,
    commands: Mapping[str, str],
    *,
    default: str = "",
    **settings: Any,
) -> typer.Typer:
    """A typer app of the commands in `package` that are installed.

    Args:
        package: Package that holds one module a command.
        commands: Name to the one line that `--help` shows, in the order of the list.
        default: Command that options without a command are meant for; empty for none.
        settings: Passed to `typer.Typer`.
    """
    group = type("Group", (LazyGroup,), {"package": package, "default": default})
    app = typer.Typer(cls=group, no_args_is_help=True, **settings)
    for name, summary in commands.items():
        if find_spec(module_name(package, name)) is not None:
            app.command(name, help=summary)(_placeholder)
    app.callback()(_no_options)  # keeps it a group, however few commands it has
    return app


def _placeholder() -> None:
    raise AssertionError("replaced by the real command before it is called")


def _no_options() -> None:
    pass
