"""The errors that a diagnosis prints are those of its files: code of the tests' own finds them again."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis import diagnose
from fricomp.diagnosis.report import write_diagnosis
from fricomp.evaluation import evaluate
from fricomp.recording import Recording
from tests.evaluation.made_joint import KINDS, Made, make_joint, torque_error


@cache
def _made(kind: str) -> Made:
    return make_joint(kind, duration=30.0)


@cache
def _diagnosed(kind: str) -> tuple[Path, dict[str, Any]]:
    made = _made(kind)
    folder = Path(mkdtemp(prefix="fricomp-test-"))
    found = diagnose(Recording(made.time, made.position, made.torque))
    write_diagnosis(found, folder)
    return folder, json.loads((folder / "diagnosis.json").read_text())


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_printed_error_is_that_of_the_file(kind: str) -> None:
    folder, record = _diagnosed(kind)
    printed = record["errors"]["file"]["torque"]
    again = torque_error(folder / "friction.json", _made(kind), printed["band"])
    assert again == pytest.approx(printed["rms"], rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_held_out_error_is_that_of_models_that_did_not_see_the_data(kind: str, tmp_path: Path) -> None:
    folder, record = _diagnosed(kind)
    content, made = json.loads((folder / "held_out.json").read_text()), _made(kind)
    recording = Recording(made.time, made.position, made.torque)
    for side in ("before", "after"):
        printed = record["errors"][side]
        if printed is None:
            continue
        squares, time = 0.0, 0.0
        for number, (model, spans) in enumerate(zip(content[side], content["times"], strict=True)):
            path = tmp_path / f"{side}-{number}.json"
            path.write_text(json.dumps(model))
            found = evaluate(path, recording, spans=spans, band=printed["torque"]["band"]).torque
            squares, time = squares + found.rms**2 * found.duration, time + found.duration
        assert (squares / time) ** 0.5 == pytest.approx(printed["torque"]["rms"], rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_files_predict_nearly_as_well_as_the_true_joint(kind: str) -> None:
    folder, record = _diagnosed(kind)
    made = _made(kind)
    found = evaluate(folder, Recording(made.time, made.position, made.torque))
    noise = 0.004 * (found.torque.band / 250.0) ** 0.5
    assert found.torque.rms < 2.5 * noise
    assert found.position[0].median < 0.006 * found.position[0].travel
    if kind != "null":
        assert record["errors"]["after"]["torque"]["rms"] < 0.8 * record["errors"]["before"]["torque"]["rms"]


@pytest.mark.slow
def test_the_picture_shows_the_error_of_the_file() -> None:
    folder, record = _diagnosed("load")
    made = _made("load")
    found = diagnose(Recording(made.time, made.position, made.torque))
    (shown,) = found.evidence.files
    after = shown.after[np.isfinite(shown.after)]
    assert float(np.sqrt(np.mean(after**2))) == pytest.approx(record["errors"]["file"]["torque"]["rms"], rel=0.05)
    assert (folder / "torque-error.png").is_file()
