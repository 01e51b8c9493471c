"""Finished cases on disk."""

from pathlib import Path

import numpy as np

from fricomp.sim_bench.studies.kit.store import RowStore


def test_a_half_written_line_is_left_out_and_does_not_spoil_the_next(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text('{"study": "x", "seed": 1}\n{"study": "x", "se')
    store = RowStore(path)
    assert list(store.find_missing(range(3), study="x")) == [0, 2]
    store.append({"study": "x", "seed": np.int64(2)})
    assert [row["seed"] for row in RowStore(path).rows(study="x")] == [1, 2]


def test_the_last_row_of_a_case_counts(tmp_path: Path) -> None:
    store = RowStore(tmp_path / "rows.jsonl")
    store.append({"case": "a", "value": 1}, {"case": "b", "value": 2}, {"case": "a", "value": 3})
    assert {name: row["value"] for name, row in RowStore(store.path).index_by_case().items()} == {"a": 3, "b": 2}
