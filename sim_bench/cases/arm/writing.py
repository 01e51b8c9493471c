"""The files of a concealed arm: what the diagnosis may read, and in another folder what it must not."""

import hashlib
import json
import secrets
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.whole_file import write_whole

from .case import ArmCase
from .friction import FIELDS
from .links import LINKS, SIMULATION, describe_links
from .spec import JOINTS, ArmSpec

ARM_ANSWER_SCHEMA = "fricomp.concealed-arm/1"


def arm_id(spec: ArmSpec) -> str:
    """A name that says nothing about what is concealed."""
    return "arm-" + hashlib.sha256(json.dumps(asdict(spec), sort_keys=True).encode()).hexdigest()[:12]


def write_arm_case(case: ArmCase, folder: Path) -> Path:
    """Write a recording of each joint and the simulation.

    Returns:
        The case's folder: `log/JOINT.csv` and `arm.xml`.
    """
    target = folder / arm_id(case.spec)
    for joint in JOINTS:
        write_whole(target / "log" / f"{joint}.csv", format_recording(case, joint))
    write_whole(target / "arm.xml", SIMULATION.read_text(encoding="utf-8"))
    return target


def format_recording(case: ArmCase, joint: str) -> str:
    """CSV of one joint, with its metadata in leading lines."""
    channels = {"time": case.time, **case.channels[joint]}
    step = float(np.min(np.diff(np.unique(channels["position"]))))
    metadata = {
        "joint": joint,
        "motion": "rotary",
        "torque_unit": "N·m",
        "torque_side": "joint",
        "torque_kind": "measured",
        "encoder_resolution": 2.0 * np.pi / 2.0 ** round(np.log2(2.0 * np.pi / step)),
        "source": "concealed arm",
    }
    head = ["# fricomp.recording/1", *(f"# {k}: {json.dumps(v, ensure_ascii=False)}" for k, v in metadata.items())]
    rows = zip(*(values.tolist() for values in channels.values()), strict=True)
    body = [",".join(f"{value:.10g}" for value in row) for row in rows]
    return "\n".join([*head, ",".join(channels), *body]) + "\n"


def write_arm_answer(case: ArmCase, folder: Path, salt: str | None = None) -> tuple[Path, str]:
    """Write the answer.

    Returns:
        Its path, `folder`/<id>.json, and the SHA-256 of its bytes, which hold the salt.
    """
    data = (json.dumps(describe_answer(case, salt), indent=1, ensure_ascii=False) + "\n").encode()
    path = folder / f"{arm_id(case.spec)}.json"
    write_whole(path, data)
    return path, hashlib.sha256(data).hexdigest()


def describe_answer(case: ArmCase, salt: str | None) -> dict[str, Any]:
    """What is true of an arm."""
    return {
        "schema": ARM_ANSWER_SCHEMA,
        "id": arm_id(case.spec),
        "spec": asdict(case.spec),
        "effects": [
            {"joint": each.joint, "name": each.name, "enr": each.enr, "parameters": dict(each.change.truth)}
            for each in case.effects
        ],
        "links_off": list(case.off),
        "links": describe_links(case.model),
        "rotors": dict(zip(JOINTS, case.model.dof_armature.tolist(), strict=True)),
        "friction": {
            joint: dict(zip(FIELDS, row.tolist(), strict=True)) for joint, row in zip(JOINTS, case.table, strict=True)
        },
        "delay": case.delay,
        "link_names": list(LINKS),
        "salt": salt or secrets.token_hex(16),
    }
