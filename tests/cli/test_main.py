"""What all commands share."""

import errno
import os
import re
import subprocess
import sys
from collections.abc import Callable

import pytest
import typer
from typer.testing import CliRunner

import fricomp
from fricomp.__main__ import run as run_from_the_start
from fricomp.calibration.identification.estimation.form import separable_law_names
from fricomp.cli import bench, check_loop, main
from fricomp.cli import run as run_command
from fricomp.cli.lazy import lazy_app
from fricomp.errors import AdapterError, FricompError, MissingExtraError, RecordingError
from fricomp.extras import extra_for


def _run_raising(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> Callable[[], None]:
    def fail() -> None:
        raise error

    monkeypatch.setattr(main, "app", fail)
    return main.run


def test_version_is_the_packages_own() -> None:
    result = CliRunner().invoke(main.app, ["--version"])
    assert result.exit_code == 0
    assert result.output.strip() == f"fricomp {fricomp.__version__}"


def test_help_lists_commands_without_importing_them() -> None:
    script = (
        "import sys; from typer.testing import CliRunner; from fricomp.cli.main import app\n"
        "result = CliRunner().invoke(app, ['--help']); assert 'bench' in result.output, result.output\n"
        "heavy = {'torch', 'mujoco', 'scipy', 'plotly', 'matplotlib', 'can', 'fricomp.cli.calibrate'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_unknown_command_is_refused_with_a_suggestion() -> None:
    result = CliRunner().invoke(main.app, ["bensh"])
    assert result.exit_code == 2
    assert "bench" in result.output


def test_an_error_of_the_library_is_one_sentence_and_status_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as exit_info:
        _run_raising(monkeypatch, RecordingError("row 3: not a number"))()
    assert exit_info.value.code == 2
    assert capsys.readouterr().err == "fricomp: row 3: not a number\n"


def test_ctrl_c_ends_with_status_130(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SystemExit) as exit_info:
        _run_raising(monkeypatch, KeyboardInterrupt())()
    assert exit_info.value.code == 130


def test_a_full_disk_is_one_sentence(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_info:
        _run_raising(monkeypatch, OSError(28, "No space left on device", "out/report.html"))()
    assert exit_info.value.code == 2
    assert capsys.readouterr().err == "fricomp: out/report.html: No space left on device\n"


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
def test_a_full_disk_is_one_sentence_where_the_file_has_no_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], number: int
) -> None:
    with pytest.raises(SystemExit) as exit_info:
        _run_raising(monkeypatch, OSError(number, os.strerror(number)))()
    assert exit_info.value.code == 2
    assert capsys.readouterr().err == f"fricomp: a file could not be written: {os.strerror(number)}\n"


def test_any_other_error_of_the_system_without_a_name_goes_through(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(OSError, match="Bad address"):
        _run_raising(monkeypatch, OSError(errno.EFAULT, "Bad address"))()


def test_a_missing_package_names_the_extra_that_brings_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as exit_info:
        _run_raising(monkeypatch, ModuleNotFoundError("No module named 'can'", name="can"))()
    assert exit_info.value.code == 2
    assert "pip install '.[can]' in the checkout" in capsys.readouterr().err


@pytest.mark.parametrize(("module", "extra"), [("torch.nn", "calibrate"), ("serial", "serial"), ("nonesuch", None)])
def test_extra_of_a_module(module: str, extra: str | None) -> None:
    assert extra_for(module) == extra


def test_a_lazy_app_leaves_out_what_is_not_installed() -> None:
    app = lazy_app("fricomp.cli", {"bench": "there", "no-such-command": "not there"})
    assert [command.name for command in app.registered_commands] == ["bench"]


@pytest.mark.parametrize("name", [command.name for command in main.app.registered_commands])
def test_every_command_shows_its_help(name: str) -> None:
    result = CliRunner().invoke(main.app, [name, "--help"])
    assert result.exit_code == 0, result.output
    assert "--install-completion" not in result.output  # of `fricomp` alone
    assert set(re.findall(r"--no-[a-z-]+", result.output)) <= {"--no-gravity"}  # whose third state is to find out


@pytest.mark.parametrize("name", [command.name for command in bench.app.registered_commands])
def test_every_benchmark_shows_its_help(name: str) -> None:
    result = CliRunner().invoke(main.app, ["bench", name, "--help"])
    assert result.exit_code == 0, result.output
    assert "--no-" not in result.output


def test_the_package_runs_as_a_module() -> None:
    command = [sys.executable, "-m", "fricomp", "--version"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == f"fricomp {fricomp.__version__}"


def _help(*command: str) -> str:
    """The words of a command's help, whatever the width of the terminal."""
    output = CliRunner().invoke(main.app, [*command, "--help"], env={"COLUMNS": "400"}).output
    return " ".join(output.split())


def test_a_benchmark_over_no_seed_is_refused_by_the_option() -> None:
    done = CliRunner().invoke(main.app, ["bench", "calibrate", "--seeds", "0"])
    assert done.exit_code == 2
    assert "--seeds" in done.output


def test_help_names_every_law() -> None:
    for name in separable_law_names():
        assert name in _help("identify")


def test_help_says_what_is_easily_missed() -> None:
    assert "(CSV: time, velocity[, position])" in _help("calibrate")
    assert "The joints move at once" in _help("run")
    assert "Make and list concealed cases" in _help("cases")
    assert _help("cases", "make").count("`fricomp cases list` has the names; drawn from the seed by default") == 4


@pytest.mark.parametrize(
    ("call", "valid"),
    [
        ("calibrate --loop foo", "'host'"),
        ("calibrate --method foo", "'least_squares'"),
        ("calibrate --noise foo", "'relative'"),
        ("identify points.csv --noise foo", "'relative'"),
        ("check-loop friction.json --inertia 1 --source foo", "'measured'"),
        ("twin canopen --link foo", "'tcp'"),
        ("twin telepathy", "'moteus'"),
    ],
)
def test_what_is_none_of_the_choices_is_refused_with_those_there_are(call: str, valid: str) -> None:
    done = CliRunner().invoke(main.app, call.split(), env={"COLUMNS": "300"})
    assert done.exit_code == 2
    assert valid in done.output


def test_a_loop_is_checked_as_it_is_run() -> None:
    checked, run = (
        {option.name: option.default for option in typer.main.get_command(module.app).params}
        for module in (check_loop, run_command)
    )
    for name in ("delay", "velocity_filter"):
        assert checked[name] == run[name]


@pytest.mark.parametrize("error", [AdapterError("no backend"), MissingExtraError("mujoco", "sim")])
def test_an_import_that_ctrl_c_ended_is_an_interruption_and_no_missing_package(
    error: FricompError, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    importing = ImportError("initialization failed")
    importing.__cause__ = KeyboardInterrupt()
    error.__cause__ = importing
    with pytest.raises(SystemExit) as ended:
        _run_raising(monkeypatch, error)()
    assert ended.value.code == 130
    assert capsys.readouterr().err.strip() == "Interrupted."


def test_a_missing_package_stays_one(monkeypatch: pytest.MonkeyPatch) -> None:
    error = MissingExtraError("mujoco", "sim")
    error.__cause__ = ImportError("no module")
    with pytest.raises(SystemExit) as ended:
        _run_raising(monkeypatch, error)()
    assert ended.value.code == 2


def test_ctrl_c_while_packages_are_imported_is_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Interrupting:
        def find_spec(self, name: str, *_: object) -> None:
            if name == "fricomp.cli.main":
                raise KeyboardInterrupt

    monkeypatch.delitem(sys.modules, "fricomp.cli.main")
    monkeypatch.setattr(sys, "meta_path", [Interrupting(), *sys.meta_path])
    with pytest.raises(SystemExit) as ended:
        run_from_the_start()
    assert ended.value.code == 130
    assert capsys.readouterr().err.strip() == "Interrupted."


def test_ctrl_c_before_a_command_begins_is_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(name: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("fricomp.cli.lazy.import_module", interrupt)
    monkeypatch.setattr(sys, "argv", ["fricomp", "identify", "log.csv"])
    with pytest.raises(SystemExit) as exit_info:
        main.run()
    assert exit_info.value.code == 130
    assert capsys.readouterr().err == "\nInterrupted.\n"


def test_an_extension_whose_import_ctrl_c_ended_is_an_interruption(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    error = ImportError("initialization failed")
    error.__cause__ = KeyboardInterrupt()
    with pytest.raises(SystemExit) as exit_info:
        _run_raising(monkeypatch, error)()
    assert exit_info.value.code == 130
    assert capsys.readouterr().err == "\nInterrupted.\n"
