"""The options of a command in a TOML file: read below those of the command line, and written with comments."""

import json
import tomllib
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Any, get_args, get_type_hints

import msgspec
import typer

from fricomp.errors import ParameterError
from fricomp.results import claim_single_files
from fricomp.untrusted import parse_toml, read_whole
from fricomp.whole_file import write_whole

OF_ONE_CALL = (
    "out",
    "dry_run",
    "overwrite",
    "resume",
    "settings",
    "write",
    "help",
    "json",
    "quiet",
    "live",
    "open_report",
    "log",
)
"""Options that say what this call does, not how: they stand on the command line only."""


def use_settings(context: typer.Context, file: Path | None) -> Path | None:
    """Callback of `--settings`: what stands in the file takes the place of defaults, and the command line wins.

    Raises:
        ParameterError: The file cannot be read, or a key or a value of it is no option's.
    """
    if file is not None:
        options = {option.name: option for option in _options(context)}
        try:
            table = parse_toml(read_whole(file).decode("utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise ParameterError(f"cannot read the settings {file}: {error}") from error
        names = {key: key.replace("-", "_") for key in table}
        for key, name in names.items():
            if name not in options:
                raise ParameterError(_explain_key(file, key, options))
        kinds = get_type_hints(context.command.callback)
        context.default_map = {name: _check_value(file, key, table[key], kinds[name]) for key, name in names.items()}
    return file


def write_settings(context: typer.Context, file: Path, *, overwrite: bool) -> None:
    """Write every option with what it means; those with their defaults are commented out.

    Args:
        context: Of the command, whose options count as they were given.
        file: Where to.
        overwrite: Whether a file there may be replaced.

    Raises:
        OutputError: There is one already, or the file cannot be written.
    """
    with claim_single_files([file], overwrite=overwrite):
        write_whole(file, "\n".join(_lines(context)) + "\n")


def _options(context: typer.Context) -> list[Any]:
    """The options of the command that a file may hold."""
    params = context.command.params
    return [one for one in params if one.param_type_name == "option" and one.name not in OF_ONE_CALL]


def _explain_key(file: Path, key: str, options: dict[str, Any]) -> str:
    if key.replace("-", "_") in OF_ONE_CALL:
        return f"{file}: {key} says what one call does: leave it out of the file, and give it on the command line"
    near = get_close_matches(key.replace("-", "_"), list(options), n=1, cutoff=0.5)
    known = f"did you mean {near[0]}?" if near else f"known are {', '.join(options)}"
    return f"{file}: there is no option {key!r}; {known}"


def _check_value(file: Path, key: str, value: Any, kind: Any) -> Any:
    """A value as the command line would give it; paths count from the folder of the file.

    Raises:
        ParameterError: It is of another kind than the option's.
    """
    is_path = Path in (kind, *get_args(kind)) or str(value).endswith(".xml")
    wanted = str if is_path else kind
    if str in (kind, *get_args(kind)) and not isinstance(value, str | bool):  # speeds may be a list, a load a number
        wanted = float | list[float]
    try:
        msgspec.convert(value, wanted)
    except msgspec.ValidationError as error:
        raise ParameterError(f"{file}: {key} = {value!r} does not fit: {str(error).replace('`', '')}") from error
    if isinstance(value, list):
        return ",".join(map(str, value))
    return str(file.absolute().parent / value) if is_path else value


def _lines(context: typer.Context) -> Iterator[str]:
    yield f"# Settings of fricomp {context.info_name}, read by --settings; the command line wins."
    yield "# What is commented out has its default."
    heading = None
    for option in _options(context):
        if option.rich_help_panel != heading:
            heading = option.rich_help_panel
            yield f"\n## {heading}"
        value, default = context.params.get(option.name), option.get_default(context)
        text = _format(default if value is None else value)
        yield f"\n# {(option.help or '').replace(chr(92) + '[', '[')}"
        yield f"{'# ' if value == default or value is None else ''}{option.name} = {text}"


def _format(value: Any) -> str:
    """A value as TOML, whose texts and numbers are written as in JSON."""
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value if isinstance(value, bool | int) else str(value or ""), ensure_ascii=False)
