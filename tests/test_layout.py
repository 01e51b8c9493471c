"""The tests mirror the source: who looks for the tests of a folder finds them under its name."""

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


def _is_source(place: Path) -> bool:
    return place.is_dir() or place.with_suffix(".py").is_file()
