"""`--json` and `--quiet` of every command; tables that fit a narrow terminal; nothing wrapped that is piped."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from fricomp.cli import bench, main
from fricomp.cli.lazy import module_name
from fricomp.cli.output import Said, hearing, with_output_options
from fricomp.cli.terminal import Table, console


def list_commands(app: typer.Typer, package: str) -> Iterator[tuple[str, ...]]:
    """Every command that can be typed, with those of groups and groups of groups."""
    from importlib import import_module

    for placeholder in app.registered_commands:
        name = str(placeholder.name)
        module = import_module(module_name(package, name))
        if hasattr(module.app, "registered_commands") and len(module.app.registered_commands) > 1:
            inner = list(list_groups(module.app, module.__name__))
            yield from ((name, *rest) for rest in inner)
        elif name != "bench":
            yield (name,)
    yield from ()


def list_groups(app: typer.Typer, package: str) -> Iterator[tuple[str, ...]]:
    for command in app.registered_commands:
        yield (str(command.name or command.callback.__name__).replace("_", "-"),)  # type: ignore[union-attr]


COMMANDS = [
    *(one for one in list_commands(main.app, "fricomp.cli") if one[0] != "bench"),
    *(("bench", *one) for one in list_commands(bench.app, "fricomp.cli.bench")),
]


def test_every_command_is_in_the_list() -> None:
    assert {one[0] for one in COMMANDS} == set(main.COMMANDS)
    assert {one[1] for one in COMMANDS if one[0] == "bench"} == set(bench.BENCHMARKS)
    assert ("adapter", "check") in COMMANDS
    assert ("bench", "mismatch", "gap") in COMMANDS


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_command_takes_json_and_quiet(command: tuple[str, ...]) -> None:
    done = CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    for option in ("json", "quiet"):
        assert len(re.findall(rf"^│ +--{option}\b", done.output, re.M)) == 1, done.output


def _names_of_options(command: tuple[str, ...]) -> list[str]:
    wide = CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": "300"}).output
    lines = re.findall(r"^│ +(?:\* +)?(--[a-z].*?) {2,}\S", wide, re.M)
    return [name for line in lines for name in re.findall(r"--?[a-z][a-z-]*", line)]


@pytest.mark.parametrize("command", [(), ("adapter",), ("bench",), *COMMANDS], ids=" ".join)
def test_help_cuts_nothing_on_a_narrow_terminal(command: tuple[str, ...]) -> None:
    names = _names_of_options(command)
    assert "--help" in names
    for columns in ("60", "80"):
        shown = CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": columns}).output
        assert "…" not in shown
        assert max(map(len, shown.splitlines())) <= int(columns)
        cut = [name for name in names if not re.search(rf"(?<![\w-]){name}(?![\w-])", shown)]
        assert cut == []


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_help_shows_every_unit(command: tuple[str, ...]) -> None:
    shown = CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": "400"}).output
    assert re.findall(r"\S* [.,;](?=\s)", shown) == []  # what a unit left behind that was taken for markup
    assert "\\[" not in shown


@pytest.mark.parametrize("command", [(), ("adapter",), ("bench",), *COMMANDS], ids=" ".join)
def test_help_shows_no_value_behind_a_flag(command: tuple[str, ...]) -> None:
    for columns in ("60", "200"):
        assert "bool" not in CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": columns}).output


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_command_shows_an_example(command: tuple[str, ...]) -> None:
    done = CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": "200"})
    examples = done.output.partition("\n Examples ")[2]
    assert f"fricomp {' '.join(command)}" in examples, done.output


def call(*arguments: object, columns: int | None = 80) -> Any:
    env = {} if columns is None else {"COLUMNS": str(columns)}
    return CliRunner().invoke(main.app, [*map(str, arguments)], env=env)


def test_adapters_answer_in_json() -> None:
    answer = json.loads(call("adapters", "--json").stdout)
    assert "canopen" in [row["backend"] for row in answer["adapters"]]


def test_quiet_says_nothing() -> None:
    done = call("adapters", "--quiet")
    assert (done.exit_code, done.output) == (0, "")


@pytest.mark.parametrize("columns", [60, 80])
def test_adapters_fit_a_terminal_and_lose_no_word(columns: int) -> None:
    out = call("adapters", columns=columns).output
    assert max(map(len, out.splitlines())) <= columns
    assert "twin-dynamixel" in out
    assert "…" not in out


def test_what_is_piped_is_not_wrapped(monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    long = "a sentence " * 40
    console().print(long)
    table = Table("a", "b")
    table.add_row("x " * 100, "y " * 100)
    console().print(table)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == long
    assert any("x " * 100 in line and "y " * 100 in line for line in lines)


def test_a_table_too_wide_for_its_words_becomes_a_list(monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    table = Table(*(f"heading_{number}" for number in range(8)))
    table.add_row(*(f"word_{number}_long" for number in range(8)))
    console().print(table)
    assert "  heading_5: word_5_long" in capsys.readouterr().out


def test_what_a_command_says_is_its_answer_where_it_has_none(capsys: Any) -> None:
    app = typer.Typer(add_completion=False)

    @app.command()
    def measure() -> None:
        table = Table("name", "value", title="Figures")
        table.add_row("a", "1")
        console().print(table)
        console().print("Done.")
        raise typer.Exit(1)

    command = with_output_options(typer.main.get_command(app))
    with pytest.raises(SystemExit) as ended:
        command.main(["--json"], standalone_mode=True)
    assert ended.value.code == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["sentences"] == ["Done."]
    assert answer["tables"] == [{"title": "Figures", "columns": ["name", "value"], "rows": [["a", "1"]]}]
    assert hearing() == Said()


def test_a_conversion_answers_in_json(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    rows = "\n".join(f"{0.01 * k:.2f},{0.1 * k:.3f},{0.5:.2f}" for k in range(400))
    log.write_text(f"time,position,torque\n{rows}\n")
    done = call("convert", log, "--out", tmp_path / "native.csv", "--json")
    assert done.exit_code == 0, done.output
    (answer,) = json.loads(done.stdout)
    assert answer["samples"] == 400
    assert Path(answer["file"]).exists()


def test_a_unit_in_help_is_no_markup(capsys: Any) -> None:
    app = typer.Typer()

    @app.command()
    def wait(seconds: float = typer.Option(1.0, help="Time [s] up to [b] seconds [0].")) -> None:
        pass

    with_output_options(typer.main.get_command(app)).main(["--help"], standalone_mode=False)
    assert "Time [s] up to [b] seconds [0]." in capsys.readouterr().out


def test_a_paragraph_of_help_is_one_line_until_the_terminal_wraps_it() -> None:
    app = typer.Typer(add_completion=False)

    @app.command(epilog="One example\nover two lines.\n\nAnother.")
    def work() -> None:
        """Does it.

        What is written
        in two lines.
        """

    command = with_output_options(typer.main.get_command(app))
    assert command.help == "Does it.\n\nWhat is written in two lines."
    assert command.epilog == "One example over two lines.\n\nAnother."


def test_an_interrupted_command_says_so_in_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("fricomp.calibration.history.read_histories", interrupted)
    done = CliRunner().invoke(main.app, ["watch", str(tmp_path)])
    assert done.exit_code == main.EXIT_INTERRUPTED
    assert done.stderr.strip() == "Interrupted."
