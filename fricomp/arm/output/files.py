"""The folder of an arm: the record, the corrected simulation, a friction model a joint, and a page."""

from __future__ import annotations

from pathlib import Path

from fricomp.errors import FricompError
from fricomp.model import save_model
from fricomp.report import draw_png, write_report
from fricomp.results import plain_name
from fricomp.whole_file import write_whole

from ..examination import ArmExamination
from ..friction_model import build_friction_model
from ..record import save_arm_record
from .corrected_simulation import correct_simulation
from .page import build_arm_page, draw_arm_charts

__all__ = ["write_arm"]


def write_arm(examination: ArmExamination, folder: Path, simulation: str | Path) -> list[Path]:
    """Write everything.

    Args:
        examination: The answer.
        folder: Where to.
        simulation: The file that was compared.

    Returns:
        The files, in the order of writing.
    """
    for old in sorted(folder.glob("joints/*/friction.json")):
        old.unlink()  # of joints that another log had
    record, found = examination.record, examination.answer.identification
    files, notes = [folder / "arm.json"], ["arm.json: this page in numbers (fricomp.arm/1)."]
    save_arm_record(record, files[0])
    for j, joint in enumerate(record.joints):
        path = folder / "joints" / plain_name(joint.name) / "friction.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        save_model(build_friction_model(found, j), path)
        files.append(path)
    notes.append(
        "joints/NAME/friction.json: the friction of each joint, for fricomp export, check-loop and Compensator."
    )
    try:
        text, lost = correct_simulation(examination.answer, simulation)
        write_whole(folder / "arm.xml", text)
        files.append(folder / "arm.xml")
        notes.append("arm.xml: the simulation with these links, rotors and friction; without meshes.")
        notes += [f"arm.xml, {line}." for line in lost]
    except (FricompError, ValueError) as error:
        notes.append(f"arm.xml is not written: {error}.")
    charts = draw_arm_charts(examination)
    for name, chart in charts.items():
        draw_png(chart, folder / f"{name}.png")
        files.append(folder / f"{name}.png")
    files.append(write_report(build_arm_page(examination, charts, tuple(notes)), folder / "report.html"))
    return files
