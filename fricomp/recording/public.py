"""Public data sets, read from where they lie through the mappings of the package.

The data are no part of the project: they are looked for in the folder that the environment variable
`FRICOMP_DATA` names.
"""

import os
from pathlib import Path

from fricomp.errors import RecordingError
from fricomp.recording.conversion import NamedRecording, convert
from fricomp.recording.mapping import Mapping, list_mappings, load_mapping
from fricomp.recording.recording import Recording


def find_public_data(name: str) -> Path | None:
    """Return the folder of a public set, e.g. "emps", or None where it is absent.

    Raises:
        RecordingError: No mapping of the package has this name.
    """
    if name not in list_mappings():
        raise RecordingError(f"unknown data set {name!r}: valid are {', '.join(list_mappings())}")
    data = os.environ.get("FRICOMP_DATA", "")
    folder = Path(data) / name
    return folder if data and folder.is_dir() else None


def read_public(name: str) -> tuple[Recording, ...]:
    """Read the recordings of a public set, in the order of its mapping.

    Args:
        name: A whole set ("emps"), or what follows from it with slashes: one recording
            ("emps/train", "ur10e/fourier/joint_3") or all joints of a file ("ur10e/fourier").

    Raises:
        RecordingError: The set or the recording is unknown, or the data are absent.
        MissingExtraError: The package that reads the format is not installed.
    """
    return tuple(found.recording for found in read_public_named(name))


def read_public_named(name: str) -> tuple[NamedRecording, ...]:
    """Like `read_public`, with the names of the recordings within their set."""
    data_set, _, part = name.partition("/")
    folder = find_public_data(data_set)
    if folder is None:
        raise RecordingError(f"the data of {data_set!r} are not here: set FRICOMP_DATA to the folder that holds them")
    mapping = load_mapping(data_set)
    found = [
        named
        for file in _files_for(mapping, part)
        for named in convert(folder / file, mapping)
        if _belongs(named.name, part)
    ]
    if not found:
        valid = ", ".join(rule.name for rule in mapping.files)
        raise RecordingError(f"{data_set!r} has no recording {part!r}: valid are {valid}")
    return tuple(found)


def _files_for(mapping: Mapping, part: str) -> list[str]:
    wanted = (rule.file for rule in mapping.files if not part or _belongs(part, rule.name) or _belongs(rule.name, part))
    return list(dict.fromkeys(wanted))


def _belongs(name: str, part: str) -> bool:
    return not part or name == part or name.startswith(part + "/")
