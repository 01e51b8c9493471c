"""Sentences say what a record holds, and no number where none was determined."""

from __future__ import annotations

import pytest

from fricomp.diagnosis import DIAGNOSIS_SCHEMA, DiagnosisRecord, NamedEffect, Quantity
from fricomp.diagnosis.record.sentence import describe_parameter, write_sentences


def test_what_is_not_determined_is_told_without_its_number() -> None:
    rise = NamedEffect(
        name="dwell_stiction",
        kind="physics",
        parameters={"rise": Quantity(0.7, "N·m", (0.6, 0.8)), "time_constant": Quantity(3.21, "s", (0.01, 400.0))},
        sentence="it sticks",
    )
    wide = Quantity(0.384, "kg·m²", (1e-9, 1e9))
    text = " ".join(
        write_sentences(
            DiagnosisRecord(
                schema=DIAGNOSIS_SCHEMA,
                verdict="missing_physics",
                effects=(rise,),
                base={"inertia": wide, "forward.coulomb_torque": Quantity(0.5, "N·m", (0.4, 0.6))},
                undetermined=("inertia", "dwell_stiction.time_constant"),
            )
        )
    )
    assert "rise 0.7 N·m (0.6 to 0.8), time constant not determined (0.01 to 400)" in text
    assert "not determined by this recording: inertia;" in text
    assert "0.384" not in text
    assert "3.21" not in text


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stiffness", "stiffness"),
        ("sine_2", "sine of recording 2"),
        ("cosine_overtone_3", "cosine, overtone 3"),
        ("amplitude_2_overtone_3", "amplitude of recording 2, overtone 3"),
    ],
)
def test_a_wave_s_number_says_of_which_recording_and_overtone_it_is(name: str, words: str) -> None:
    assert describe_parameter(name) == words
