"""An arm on the command line: all joints from one log in which all of them move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from fricomp.cli.option.panel import arm_option, log_option
from fricomp.errors import ParameterError
from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    from fricomp.arm import ArmExamination
    from fricomp.arm.log import ArmLog
    from fricomp.diagnosis import Diagnosis
    from fricomp.recording import Recording

Match = Annotated[
    list[str] | None, arm_option(help="RECORDED=SIMULATED, where names of joints differ; commas between.")
]
Gain = Annotated[
    list[str] | None, arm_option(help="JOINT=N·m/A, gear included, where currents were logged; once a joint.")
]
Channel = Annotated[
    list[str] | None, log_option(help="CHANNEL=COLUMN, where several could be one: torque=tau_measured.")
]
LogMapping = Annotated[str, log_option(help="Mapping file, or one in the package, for a log without such names.")]
Payload = Annotated[bool, arm_option("--payload", help="The simulation is right but for what the arm carries.")]


@dataclass(frozen=True)
class ArmOptions:
    """What the command line says of an arm."""

    match: Sequence[str] | None = None
    gain: Sequence[str] | None = None
    channel: Sequence[str] | None = None
    mapping: str = ""

    @property
    def names(self) -> dict[str, str]:
        """Names in the simulation by names in the log."""
        from fricomp.arm.rigid.naming import parse_names

        return parse_names(self.match or ())

    @property
    def channels(self) -> dict[str, str]:
        """Column by channel."""
        return _split(self.channel or (), "--channel", "CHANNEL=COLUMN, such as torque=tau_measured")

    @property
    def gains(self) -> dict[str, float]:
        """Torque of one ampere by joint [N·m/A]."""
        pairs = _split(self.gain or (), "--gain", "JOINT=GAIN, such as elbow=9.8")
        try:
            return {name: float(value) for name, value in pairs.items()}
        except ValueError as error:
            raise ParameterError(f"--gain: {error}: write JOINT=GAIN, such as elbow=9.8 [N·m/A]") from error

    def refuse(self, why: str) -> None:
        """Refuse what is of arms alone.

        Raises:
            ParameterError: Something of it was given.
        """
        given = {"--match": self.match, "--gain": self.gain}
        for name in (name for name, value in given.items() if value):
            raise ParameterError(f"{name} {why}")


def read_joint(path: Path, options: ArmOptions, joint: str | None, simulation: Path | None = None) -> Recording:
    """The recording of one joint, by the mapping, the columns and the names that were given.

    Args:
        path: Of the log.
        options: As given; `--match` says what the log calls the joint.
        joint: Its name; None where there is only one.
        simulation: That has it.

    Raises:
        RecordingError: It cannot be read, or is of several joints.
    """
    from fricomp.cli.terminal import console
    from fricomp.errors import RecordingError
    from fricomp.recording import convert, load_mapping
    from fricomp.recording.file import read_content
    from fricomp.simulation_file import list_joints

    if not options.mapping:
        logged = next((recorded for recorded, there in options.names.items() if there == joint), joint)
        simulated = () if simulation is None or logged != joint else list_joints(simulation)
        content = read_content(path, channels=options.channels, joint=logged, simulated=simulated)
        for finding in content.findings:
            console(stderr=True).print(f"{path.name}: {finding}", soft_wrap=True)
        return content.recording if logged == joint else content.recording.with_metadata(joint=joint)
    found = list(convert(path, load_mapping(options.mapping)))
    if len(found) > 1 and joint is not None:
        found = [one for one in found if joint in (one.name, one.recording.metadata.joint)] or found
    if len(found) > 1:
        names = ", ".join(one.name for one in found)
        raise RecordingError(f"{path} holds {len(found)} recordings, {names}: take one by --joint NAME")
    return found[0].recording


def _split(texts: Sequence[str], option: str, form: str) -> dict[str, str]:
    each = [text.strip() for pair in texts for text in pair.split(",") if text.strip()]
    for text in each:
        if "=" not in text:
            raise ParameterError(f"{option} {text!r} has no '=': write {form}")
    return {name.strip(): value.strip() for name, value in (text.split("=", 1) for text in each)}


def find_arm_log(sources: Sequence[str], simulation: Path | None, options: ArmOptions) -> ArmLog | None:
    """The log of an arm that is meant; None where the sources are recordings of one joint.

    Raises:
        RecordingError: A source cannot be read.
        ParameterError: It is the log of an arm, and no simulation is given.
    """
    from fricomp.recording.named.native import is_native

    asked = options.channels or options.mapping
    given = [Path(one) for one in sources]
    if (
        not asked
        and all(path.is_file() and is_native(path) for path in given)
        and (len(given) == 1 or simulation is None)
    ):
        return None  # before the packages of arms are loaded, which takes longer than a look at the file
    from fricomp.arm.log import list_log_files, read_arm_log

    files = list_log_files(sources) if simulation is not None or options.mapping else given
    if not asked and all(map(is_native, files)) and (len(files) == 1 or simulation is None):
        return None
    log = read_arm_log(
        files, mapping=options.mapping, channels=options.channels, simulation=simulation, names=options.names
    )
    if simulation is None and log.is_arm:
        if len(files) == 1 and not options.mapping:
            return None  # whose reader takes the joint that moves alone, or names them
        names = ", ".join(one.metadata.joint for one in log.sessions[0])
        raise ParameterError(
            f"{files[0]} is the log of {len(log.sessions[0])} joints, {names}: give the --simulation of their arm, or "
            "take one by --joint NAME"
        )
    return log if log.is_arm else None


def choose_joint(log: ArmLog, simulation: Path) -> str | None:
    """The joint of a simulation that has one alone, told; None where none of a log of several is clearly that.

    A gripper beside the joint, or the rest of an arm, is no joint of that simulation.
    """
    from fricomp.cli.terminal import console
    from fricomp.recording.named.joints.joint_name import select_joint
    from fricomp.simulation_file import list_joints

    (wanted,) = list_joints(simulation)
    logged = [one.metadata.joint for one in log.sessions[0]]
    if select_joint(logged, wanted, [wanted]) is None:
        return None  # the reader of one joint takes that which moves alone, or names them
    said = f"{simulation.name} has the joint {wanted!r} alone: of {', '.join(logged)} that one is examined"
    console(stderr=True).print(said, soft_wrap=True)
    return wanted


def find_payload(log: ArmLog, simulation: Path, out: Path, options: ArmOptions, *, overwrite: bool) -> Diagnosis:
    """Say what an arm carries at its end, from one session or two, and write the folder of a diagnosis.

    Raises:
        FricompError: It cannot be found, or the folder holds something else.
    """
    from fricomp.arm.log.drive_gain import take_given_gains
    from fricomp.arm.payload import diagnose_payload
    from fricomp.cli.terminal import progress
    from fricomp.diagnosis.report import write_diagnosis
    from fricomp.result_kinds import DIAGNOSIS
    from fricomp.results import claim_folder

    with claim_folder(out, DIAGNOSIS, overwrite=overwrite, inputs=(*log.files, simulation)) as claim, progress() as bar:
        bar.add_task("weighing the payload", total=None)
        recordings = take_given_gains(log.recordings, options.gains)
        diagnosis = diagnose_payload(recordings, simulation, match=options.names)
        claim.clear()
        write_diagnosis(diagnosis, out, facts={"log": ", ".join(map(str, log.files)), "simulation": str(simulation)})
    return diagnosis


def run_arm(
    log: ArmLog, simulation: Path, out: Path, options: ArmOptions, seed: int, *, overwrite: bool
) -> ArmExamination:
    """Examine an arm, write its folder and say what was found.

    Raises:
        FricompError: It cannot be examined, or the folder holds something else.
    """
    from fricomp.api.examine_arm import examine_arm
    from fricomp.arm.output.page import build_joint_table
    from fricomp.cli.fleet import rich_table
    from fricomp.cli.output import answer
    from fricomp.cli.terminal import console, progress

    require(*REPORT, "mujoco")
    show = console()
    for note in log.notes:
        show.print(note, style="dim", markup=False, soft_wrap=True)
    with progress() as bar:
        task = bar.add_task("reading", total=None)

        def say(what: str) -> None:
            bar.update(task, description=what)

        settings: Mapping[str, object] = {"names": options.names, "gains": options.gains, "seed": seed}
        found = examine_arm(log, simulation, out=out, overwrite=overwrite, progress=say, **settings)  # type: ignore[arg-type]
    answer(found.record)
    for number, sentence in enumerate(found.record.summary):
        show.print(sentence, style="bold" if number == 0 else None, markup=False)
    show.print(rich_table(build_joint_table(found.record)))
    listed = ", ".join(sorted(path.name for path in out.iterdir() if path.suffix != ".png"))
    where = f"Friction, links, errors of the files and all remarks: report.html. In {out}: {listed}"
    show.print(where, soft_wrap=True, markup=False)
    return found
