"""Many joints diagnosed, each into a folder of its own, and a page on all of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricomp.cli.diagnosis.joint import run_diagnosis
from fricomp.cli.fleet import FleetRun, run_joints, show_fleet
from fricomp.extras import require

if TYPE_CHECKING:
    from fricomp.fleet import FleetJoint, FleetRow


def diagnose_fleet(
    sources: Sequence[str], out: Path, options: dict[str, Any], given: dict[str, Path | None], run: FleetRun
) -> None:
    """Every joint into a folder of its own, and a page on all of them."""
    from functools import partial

    from fricomp.cli.diagnosis.folder import check_folder
    from fricomp.diagnosis.report import build_fleet_table, write_fleet
    from fricomp.fleet import FleetJoint, list_joints

    require("pyarrow")
    defaults = FleetJoint("", (), options["simulation"], options["joint"], given["friction"])
    joints = list_joints(sources, defaults)
    work = partial(_diagnose_one, options=options, given=given)

    def check(joint: FleetJoint, folder: Path) -> None:
        inputs = (joint.simulation, joint.friction, given["simulated"], given["controller"])
        check_folder(folder, (*joint.recordings, *(path for path in inputs if path is not None)))

    settings = _fleet_settings(options, given) | {"command": "diagnose"}
    rows = run_joints(joints, work, out, run, settings, "diagnosing joints", check=check)
    show_fleet(rows, build_fleet_table, write_fleet(rows, out), run)


def _fleet_settings(options: dict[str, Any], given: dict[str, Path | None]) -> dict[str, str]:
    """What the rows of a fleet depend on: options, whole paths, and the content of the files that all joints share.

    The content of a simulation or a friction model is kept with the row of each joint.
    """
    from hashlib import sha256

    from fricomp.untrusted import read_whole

    settings = {}
    for name, value in {**options, **given}.items():
        settings[name] = str(value.absolute() if isinstance(value, Path) else value)
        if name in ("simulated", "controller") and value is not None:
            settings[name] += f", sha256 {sha256(read_whole(value)).hexdigest()}"
    return settings


def _diagnose_one(joint: FleetJoint, out: Path, *, options: dict[str, Any], given: dict[str, Path | None]) -> FleetRow:
    """On a worker: diagnose one joint of a fleet."""
    from fricomp.diagnosis.report import build_fleet_row

    options = options | {"simulation": joint.simulation, "joint": joint.joint}
    run = run_diagnosis(joint.recordings, out, options, given | {"friction": joint.friction}, quiet=True)
    return build_fleet_row(run.diagnosis.record) | {"warnings": "\n".join(run.warnings)}
