"""What `gz topic -e` prints of the joints of a simulation is read, as protobuf's text and as JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fricomp.recording.named.log import read_named_log

from .test_forms_of_printouts import POSITION, TIME, TORQUE, VELOCITY


def show_number(name: str, value: float) -> str:
    """A field; what is zero is not shown."""
    return f"    {name}: {value:.9g}\n" if value else ""


def show_joint(name: str, values: tuple[float, float, float]) -> str:
    fields = "".join(map(show_number, ("position", "velocity", "force"), values))
    mount = "  pose {\n    position {\n      z: 0.4\n    }\n  }\n"
    return f'joint {{\n  name: "{name}"\n  id: 8\n{mount}  axis1 {{\n    xyz {{\n      z: 1\n    }}\n{fields}  }}\n}}\n'


def show_message(time: float, values: tuple[float, float, float], between: str) -> str:
    seconds, rest = divmod(round(1e9 * time), 10**9)
    stamp = (f"    sec: {seconds}\n" if seconds else "") + (f"    nsec: {rest}\n" if rest else "")
    head = f'header {{\n  stamp {{\n{stamp}  }}\n}}\nname: "arm"\nid: 3\n'
    return head + show_joint("shoulder", (0.25, 0.0, 0.5)) + show_joint("elbow", values) + between


@pytest.mark.parametrize("between", ["\n", ""])
def test_joints_of_a_printed_model_are_read(between: str, tmp_path: Path) -> None:
    rows = zip(TIME, POSITION, VELOCITY, TORQUE, strict=True)
    text = "".join(show_message(t, (q, v, tau), between) for t, q, v, tau in rows)
    (tmp_path / "joints.txt").write_text(text + 'header {\n  stamp {\n    sec: 9\n  }\n}\njoint {\n  name: "el')
    log = read_named_log(tmp_path / "joints.txt")
    found = {one.metadata.joint: one for one in log.recordings}
    assert sorted(found) == ["elbow", "shoulder"]
    assert found["elbow"].metadata.torque_unit == "N·m"
    assert found["elbow"].time == pytest.approx(TIME - TIME[0], abs=1e-8)
    for name, values in (("position", POSITION), ("velocity", VELOCITY), ("torque", TORQUE)):
        assert found["elbow"].channels[name] == pytest.approx(values, abs=1e-6)
    assert np.ptp(found["shoulder"].position) == 0.0


def test_the_same_messages_in_json_are_read(tmp_path: Path) -> None:
    lines = []
    for t, q, v, tau in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True):
        seconds, rest = divmod(round(1e9 * t), 10**9)
        axis = {"xyz": {"z": 1.0}, "position": q, "velocity": v, "force": tau}
        joint = {"name": "elbow", "id": 8, "axis1": axis}
        lines.append(json.dumps({"header": {"stamp": {"sec": str(seconds), "nsec": rest}}, "joint": [joint]}))
    (tmp_path / "joints.json").write_text("\n".join(lines) + "\n")
    (recording,) = read_named_log(tmp_path / "joints.json").recordings
    assert recording.metadata.motion == "rotary"
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)
