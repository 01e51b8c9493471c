"""The version of a diagnosis follows its modules and nothing else."""

from __future__ import annotations

from pathlib import Path

from fricomp.sim_bench.studies.diagnosis_version import diagnosis_version, imported_diagnosis


def test_the_version_follows_contents_and_names(tmp_path: Path) -> None:
    versions = []
    for name, files in {
        "one": {"search.py": "a = 1\n"},
        "same": {"search.py": "a = 1\n", "note.txt": "b"},
        "changed": {"search.py": "a = 2\n"},
        "renamed": {"found.py": "a = 1\n"},
        "deeper": {"search.py": "a = 1\n", "effects/cogging.py": ""},
    }.items():
        for path, content in files.items():
            (tmp_path / name / path).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name / path).write_text(content)
        versions.append(diagnosis_version(tmp_path / name))
    assert versions[0] == versions[1]
    assert len({*versions}) == 4


def test_the_diagnosis_is_the_one_that_is_imported() -> None:
    from fricomp import diagnosis

    assert Path(diagnosis.__file__).resolve().parent == imported_diagnosis()
