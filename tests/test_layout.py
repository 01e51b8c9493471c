"""The tests mirror the source: who looks for the tests of a folder finds them under its name."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parent.parent
SOURCES = (ROOT / "fricomp", ROOT)
"""Where the packages of the source are: `fricomp`, and those that are linked into it."""


def test_every_folder_of_tests_is_a_package_or_a_module_of_the_source() -> None:
    tests = ROOT / "tests"
    folders = [path.relative_to(tests) for path in tests.rglob("*") if path.is_dir() and any(path.glob("test_*.py"))]
    assert folders
    homeless = [str(name) for name in folders if not any(_is_source(source / name) for source in SOURCES)]
    assert homeless == []


def test_no_folder_of_the_source_holds_more_modules_than_a_reader_takes_in() -> None:
    packages = (ROOT / name for name in ("adapters", "calibration", "fricomp", "sim_bench"))
    folders = [folder for package in packages for folder in (package, *package.rglob("*/"))]
    assert folders
    assert [str(folder) for folder in folders if len(list(folder.glob("*.py"))) > 25] == []


def test_no_module_lists_in_all_what_its_names_say_already() -> None:
    lists = [(path, listed, public) for path, listed, public in _read_lists() if path.name != "__init__.py"]
    assert lists
    assert [str(path) for path, listed, public in lists if listed == public] == []


def test_every_layer_and_every_stage_of_the_diagnosis_stands_in_the_architecture() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    layers, stages = ({name.strip() for row in one["layers"] for name in row.split(":")} for one in contracts[:2])
    folders = {name for name in stages if (ROOT / "fricomp" / "diagnosis" / name).is_dir()}
    assert {"laws", "evaluation"} <= layers
    assert {"joint", "delivery"} <= folders
    text = (ROOT / "ARCHITECTURE.md").read_text("utf-8")
    known = {word for name in text.split("`")[1::2] for word in name.removeprefix("fricomp.").split("/")}
    assert (layers | folders) - {"__main__"} - known == set()


def _read_lists() -> Iterator[tuple[Path, set[str], set[str]]]:
    """Each module with `__all__`, what stands in it, and the names without an underscore that the module makes."""
    for path in (file for name in ("adapters", "calibration", "fricomp", "sim_bench") for file in _walk(ROOT / name)):
        text = path.read_text(encoding="utf-8")
        if "__all__" not in text:
            continue
        made: dict[str, ast.stmt] = {name: node for node in ast.parse(text).body for name in _list_made(node)}
        if "__all__" in made:
            listed = {one.value for one in ast.walk(made["__all__"]) if isinstance(one, ast.Constant)}
            yield path, {str(one) for one in listed}, {name for name in made if not name.startswith("_")}


def _walk(package: Path) -> Iterator[Path]:
    return (path for path in package.rglob("*.py") if not any(one.is_symlink() for one in path.parents))


def _list_made(node: ast.stmt) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    return [one.id for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)]


def _is_source(place: Path) -> bool:
    return place.is_dir() or place.with_suffix(".py").is_file()
