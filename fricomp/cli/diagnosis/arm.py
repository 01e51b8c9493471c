"""An arm on the command line: all joints from one recording in which all of them move."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    from fricomp.recording import Recording

__all__ = ["is_arm", "parse_names", "run_arm"]


def is_arm(recordings: Sequence[Recording]) -> bool:
    """Whether recordings are of several joints, one of each, from the same time."""
    names = Counter(one.metadata.joint for one in recordings)
    together = max(one.time[0] for one in recordings) < min(one.time[-1] for one in recordings)
    return len(names) > 1 and max(names.values()) == 1 and together


def parse_names(pairs: Sequence[str]) -> dict[str, str]:
    """Names in the simulation by names in the recordings, from RECORDED=SIMULATED.

    Raises:
        ParameterError: One has no equals sign.
    """
    from fricomp.errors import ParameterError

    for pair in pairs:
        if "=" not in pair:
            raise ParameterError(f"--match {pair!r} has no '=': write RECORDED=SIMULATED, such as joint_1=shoulder_pan")
    return dict(pair.split("=", 1) for pair in pairs)


def run_arm(
    paths: Sequence[Path],
    recordings: Sequence[Recording],
    simulation: Path,
    out: Path,
    names: dict[str, str],
    *,
    seed: int = 0,
    overwrite: bool = False,
) -> None:
    """Examine an arm, write its folder and say what was found.

    Raises:
        FricompError: It cannot be examined, or the folder holds something else.
    """
    from fricomp.arm import examine_arm
    from fricomp.arm.files import write_arm
    from fricomp.arm.page import build_joint_table, build_link_table
    from fricomp.cli.fleet import rich_table
    from fricomp.cli.terminal import console, progress
    from fricomp.results import ARM, claim_folder

    require(*REPORT, "mujoco")
    with claim_folder(out, ARM, overwrite=overwrite, inputs=(*paths, simulation)) as claim, progress() as bar:
        task = bar.add_task("reading", total=None)

        def say(what: str) -> None:
            bar.update(task, description=what)

        examination = examine_arm(recordings, simulation, names=names, seed=seed, progress=say)
        say("writing the report")
        claim.clear()
        files = write_arm(examination, out, simulation)
    show = console()
    for number, sentence in enumerate(examination.record.sentences):
        show.print(sentence, style="bold" if number == 0 else None)
    for table in (build_joint_table(examination.record), build_link_table(examination.record)):
        show.print()
        show.print(rich_table(table))
    listed = ", ".join(sorted({path.relative_to(out).parts[0] for path in files if path.suffix != ".png"}))
    show.print(f"\nIn {out}: {listed}", soft_wrap=True)
