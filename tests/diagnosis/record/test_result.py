"""`diagnosis.json` survives a round trip, has a schema, and refuses what it is not."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest

from fricomp.diagnosis import (
    DIAGNOSIS_SCHEMA,
    DiagnosisRecord,
    HeldOut,
    NamedEffect,
    Quantity,
    diagnosis_json_schema,
    load_diagnosis,
    save_diagnosis,
)
from fricomp.errors import DiagnosisError


def example() -> DiagnosisRecord:
    effect = NamedEffect(
        name="load_coulomb",
        kind="physics",
        parameters={"coefficient": Quantity(0.118, "N·m/N·m", (0.112, 0.124))},
        indistinguishable_from=("torque_gain_error",),
        location={"load_torque": [(2.0, 5.5)]},
        share=0.83,
    )
    held = HeldOut(
        rmse_before=0.23, rmse_after=0.03, noise_floor=0.02, unit="N·m", ci95_reduction=(0.84, 0.89), explained=0.98
    )
    return DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict="missing_physics", effects=(effect,), heldout=held)


def test_round_trip(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    save_diagnosis(example(), path)
    assert load_diagnosis(path) == example()


def test_the_error_of_the_refitted_base_is_the_second_where_the_first_is_of_parameters_as_given() -> None:
    held = example().heldout
    assert held is not None
    assert held.rmse_refitted == 0.23
    assert msgspec.structs.replace(held, before="given").rmse_refitted == 0.03


def test_numbers_of_numpy_are_written_as_numbers(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    save_diagnosis(msgspec.structs.replace(example(), noise_ratio=np.float64(1.5), coverage=np.float32(0.5)), path)
    assert (load_diagnosis(path).noise_ratio, load_diagnosis(path).coverage) == (1.5, 0.5)


def test_schema_names_every_verdict() -> None:
    text = str(diagnosis_json_schema())
    for verdict in ("consistent", "parameters", "measurement", "missing_physics", "unknown_physics", "bad_data"):
        assert verdict in text


@pytest.mark.parametrize("content", ["", "{}", '{"schema": "fricomp.diagnosis/9", "verdict": "consistent"}'])
def test_foreign_files_are_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "diagnosis.json"
    path.write_text(content)
    with pytest.raises(DiagnosisError):
        load_diagnosis(path)
