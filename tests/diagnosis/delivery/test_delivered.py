"""The errors that a diagnosis prints are those of its files: code of the tests' own finds them again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from fricomp.diagnosis import Diagnosis, diagnose
from fricomp.diagnosis.report import write_diagnosis
from fricomp.evaluation import evaluate
from fricomp.recording import Recording
from tests.evaluation.made_joint import KINDS, Made, make_joint, torque_error

pytestmark = pytest.mark.slow


class Delivered(NamedTuple):
    """A made joint, its diagnosis, and what was written of it."""

    kind: str
    made: Made
    found: Diagnosis
    folder: Path
    record: dict[str, Any]


@pytest.fixture(scope="module", params=KINDS)
def delivered(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Delivered:
    made, folder = make_joint(request.param, duration=15.0), tmp_path_factory.mktemp(request.param)
    found = diagnose(Recording(made.time, made.position, made.torque))
    write_diagnosis(found, folder)
    return Delivered(request.param, made, found, folder, json.loads((folder / "diagnosis.json").read_text()))


def test_the_printed_error_is_that_of_the_file(delivered: Delivered) -> None:
    printed = delivered.record["errors"]["file"]["torque"]
    again = torque_error(delivered.folder / "friction.json", delivered.made, printed["band"])
    assert again == pytest.approx(printed["rms"], rel=0.03)


def test_the_held_out_error_is_that_of_models_that_did_not_see_the_data(delivered: Delivered, tmp_path: Path) -> None:
    content, made = json.loads((delivered.folder / "held_out.json").read_text()), delivered.made
    recording = Recording(made.time, made.position, made.torque)
    for side in ("before", "after"):
        printed = delivered.record["errors"][side]
        if printed is None:
            continue
        squares, time = 0.0, 0.0
        for number, (model, spans) in enumerate(zip(content[side], content["times"], strict=True)):
            path = tmp_path / f"{side}-{number}.json"
            path.write_text(json.dumps(model))
            found = evaluate(path, recording, spans=spans, band=printed["torque"]["band"]).torque
            squares, time = squares + found.rms**2 * found.duration, time + found.duration
        assert (squares / time) ** 0.5 == pytest.approx(printed["torque"]["rms"], rel=0.03)


def test_the_files_predict_nearly_as_well_as_the_true_joint(delivered: Delivered) -> None:
    made, record = delivered.made, delivered.record
    found = evaluate(delivered.folder, Recording(made.time, made.position, made.torque))
    noise = 0.004 * (found.torque.band / 250.0) ** 0.5
    assert found.torque.rms < 2.5 * noise
    assert found.position[0].median < 0.006 * found.position[0].travel
    if delivered.kind != "null":
        assert record["errors"]["after"]["torque"]["rms"] < 0.8 * record["errors"]["before"]["torque"]["rms"]


def test_the_picture_shows_the_error_of_the_file(delivered: Delivered) -> None:
    (shown,) = delivered.found.evidence.files
    after = shown.after[np.isfinite(shown.after)]
    assert float(np.sqrt(np.mean(after**2))) == pytest.approx(
        delivered.record["errors"]["file"]["torque"]["rms"], rel=0.05
    )
    assert (delivered.folder / "torque-error.png").is_file()
