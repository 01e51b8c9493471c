"""The folder of an arm: the record, the corrected simulation, a friction model a joint, and a page."""

from __future__ import annotations

from pathlib import Path

from fricomp.blas import one_blas_thread
from fricomp.diagnosis.report import write_diagnosis
from fricomp.errors import FricompError
from fricomp.report import draw_png, write_report
from fricomp.result_kinds import DIAGNOSIS
from fricomp.results import find_results, plain_name
from fricomp.whole_file import write_whole

from ..examination import ArmExamination
from ..record import save_arm_record
from .choice import WrittenFiles
from .corrected_simulation import correct_simulation
from .joint_diagnosis import diagnose_joints
from .page import build_arm_page, draw_arm_charts


@one_blas_thread()
def write_arm(examination: ArmExamination, folder: Path, simulation: str | Path, written: WrittenFiles) -> list[Path]:
    """Write everything.

    Args:
        examination: The answer.
        folder: Where to.
        simulation: The file that was compared.
        written: What the corrected simulation and the friction models are made of, and what they are worth.

    Returns:
        The files, in the order of writing.
    """
    _remove_joints(folder / "joints")
    record, made = examination.record, written.answer
    files, notes = [folder / "arm.json"], ["arm.json: this page in numbers (fricomp.arm/1)."]
    save_arm_record(record, files[0])
    facts = {"simulation": str(simulation)}
    for diagnosis in diagnose_joints(examination, written):
        own = folder / "joints" / plain_name(diagnosis.record.joint)
        files += write_diagnosis(diagnosis, own, facts=facts, pictures=False).files
    notes.append(
        "joints/NAME: report.html and diagnosis.json of each joint, and its friction.json for fricomp export, "
        "check-loop and Compensator."
    )
    try:
        text, lost = correct_simulation(made, simulation)
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


def _remove_joints(folder: Path) -> None:
    """Remove the diagnoses of joints that another log had."""
    for joint in sorted(folder.iterdir()) if folder.is_dir() else ():
        for name in find_results(joint, DIAGNOSIS) if joint.is_dir() and not joint.is_symlink() else ():
            (joint / name).unlink()
