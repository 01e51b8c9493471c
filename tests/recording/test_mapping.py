"""Mapping files: those of the package load, and what a mapping cannot say is refused with the reason."""

from pathlib import Path

import pytest

from fricomp.errors import RecordingError
from fricomp.recording import list_mappings, load_mapping

_NUMBERED = """
[channels]
time = { column = 1 }
position = { column = 2 }
torque = { column = 3 }
"""


@pytest.mark.parametrize("name", list_mappings())
def test_mappings_of_the_package_load_and_say_where_their_data_come_from(name: str) -> None:
    mapping = load_mapping(name)
    assert mapping.metadata["source"]
    assert len({rule.name for rule in mapping.files}) == len(mapping.files)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[channels", "mapping .*toml: "),
        ("[chanels]", "unknown field chanels|missing required field"),
        ("[channels]\ntime = { column = 1 }", "channel 'position' is missing"),
        (_NUMBERED + "effort = { column = 4 }", "unknown channel 'effort': valid are time"),
        (_NUMBERED + "velocity = { colum = 4 }", "unknown field colum"),
        (_NUMBERED + "velocity = { column = 4, constant = 1 }", "exactly one of column, constant"),
        (_NUMBERED + "velocity = { column = 4, sign = 2 }", r"channels\[...\].sign"),
        (_NUMBERED + "velocity = { column = 0 }", ">= 1"),
        (_NUMBERED + "velocity = { column = 4, signed_bits = 2000 }", "<= 64"),
        (_NUMBERED + "velocity = { column = 4, signed_bits = -8 }", ">= 1"),
        (_NUMBERED + "velocity = { column = 4, unwrap = 0.0 }", "> 0"),
        ("[source]\ncolumns = 0\n" + _NUMBERED, ">= 1"),
    ],
)
def test_bad_mappings_are_refused_with_the_reason(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(RecordingError, match=message):
        load_mapping(path)
    with pytest.raises(RecordingError, match=r"no mapping 'nowhere' \(.*\): give a TOML file or one of am-d02-arm"):
        load_mapping("nowhere")


def test_a_mapping_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "log.toml"
    path.write_text(_NUMBERED, encoding="utf-8-sig")
    assert load_mapping(path).channels["torque"].column == 3
