"""`fricomp.diagnose`: what physics a simulation leaves out, from recordings or their files."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from fricomp.arm.payload import diagnose_payload, group_sessions
from fricomp.diagnosis import Controller, Diagnosis, RigidJoint, diagnose_against, read_controller
from fricomp.diagnosis import diagnose as diagnose_joint
from fricomp.errors import DiagnosisError
from fricomp.extras import require
from fricomp.model import FrictionModel, load_model
from fricomp.recording import Recording, read_recording
from fricomp.recording.file import take_recording
from fricomp.result_kinds import DIAGNOSIS
from fricomp.results import claim_folder
from fricomp.simulation_file import list_joints

SHORTEST_RECORDING = 5.0
"""Below it a diagnosis fails, or finds unknown physics in a joint with nothing missing: blocks that can be held out,
slow and fast motion and reversals do not fit into it [s]."""

Source = Recording | str | os.PathLike[str]


def diagnose(
    recordings: Source | Sequence[Source],
    simulation: RigidJoint | str | os.PathLike[str] | None = None,
    *,
    joint: str | None = None,
    friction: FrictionModel | str | os.PathLike[str] | None = None,
    simulated: Source | None = None,
    controller: Controller | str | os.PathLike[str] | None = None,
    thorough: bool = False,
    seed: int = 0,
    names: Sequence[str] | None = None,
    payload: bool = False,
    simulation_error: float | None = None,
    out: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Say what physics a simulation of a joint leaves out, with its parameters, from recordings of the real joint.

    The simulation's joint obeys

        tau = J a + g_c cos(q) + g_s sin(q) + tau_0 + tau_friction(v) + w(q, v, a, t, ...),

    with w = 0. Its parameters are refitted first, so that what is missing is not taken for wrong parameters. Then each
    effect of the catalogue is tried for w; one is named where it explains the residual on held-out data better
    than chance, as simulated joints with nothing missing show it, and where no other effect does as well.

    Args:
        recordings: One or several recordings of one joint, or their files: half a minute or more, with slow and fast
            motion and reversals. Two payloads or two speeds tell more effects apart than twice the same motion.
        simulation: MJCF or URDF file whose inertia and gravity are compared. Without it they are identified, and only
            physics is looked for.
        joint: Name of the joint in the simulation and in the recordings; needed where there are several.
        friction: Friction model of the simulation, or its file. Without it friction is identified.
        simulated: What your simulator recorded under the same commands, in place of `simulation` and `friction`: for
            simulators that write no MJCF or URDF.
        controller: The loop that moved the joint, or its file. It is estimated where the reference was recorded; give
            it where the reference was not.
        thorough: Repeat the whole diagnosis with other noise in its nulls, and say how often the names come again. The
            answer stays the same; it takes four times as long.
        seed: Of the bands of the report's maps; names, numbers and errors do not depend on it.
        names: What each recording is called in the answer; the names of their files if None.
        payload: With the recordings of all joints of an arm from one session: its simulation is right, but for what
            the arm carries at its end. Two sessions of an arm are compared for their payloads without it.
        simulation_error: Relative standard deviation by which inertia and gravity of `simulation` may be off, 0.2 if
            None: a smaller one if you trust it, a larger one for a first guess. Departures from it cost by this prior.
        out: Folder for the report, the record and the models, as the command writes it; nothing is written if None.
        overwrite: Replace the diagnosis that `out` holds already.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: A recording is too short, the simulation cannot be read, or the recordings do not belong
            together.
        RecordingError: A file cannot be read.
        OutputError: `out` holds something that is not to be replaced.
        MissingExtraError: A package is not installed; the message names the extra that brings it.
    """
    require("ruptures", extra="diagnose")
    series: Sequence[Source] = recordings if isinstance(recordings, list | tuple) else [recordings]  # type: ignore[list-item]
    given = [take_recording(one) for one in series]
    settings: dict[str, Any] = {
        "joint": joint, "thorough": thorough, "seed": seed, "progress": progress,
        "controller": read_controller(Path(controller)) if isinstance(controller, str | os.PathLike) else controller,
        "payload": payload,
        "names": names or [_name_of(one, number) for number, one in enumerate(given, 1)],
    }  # fmt: skip

    def read() -> list[Recording]:
        return [read_long_recording(one, joint, simulation) for one in given]

    if out is None:
        return _diagnose(read(), simulation, friction, simulated, settings, simulation_error)
    from fricomp.diagnosis.report import write_diagnosis

    paths = [simulation, friction, simulated, controller, *given]
    inputs = [Path(one) for one in paths if isinstance(one, str | os.PathLike)]
    with claim_folder(Path(out), DIAGNOSIS, overwrite=overwrite, inputs=inputs) as claim:
        found = _diagnose(read(), simulation, friction, simulated, settings, simulation_error)
        claim.clear()
        into = Path(simulation) if isinstance(simulation, str | os.PathLike) else None
        write_diagnosis(found, out, simulation=into, joint=joint)
    return found


def read_long_recording(
    path: Source, joint: str | None = None, simulation: RigidJoint | str | os.PathLike[str] | None = None
) -> Recording:
    """A recording that is long enough to be diagnosed, from its file or as it is.

    Args:
        path: Of its file, or the recording.
        joint: Which one of a log of several.
        simulation: That has it, perhaps under another number.

    Raises:
        DiagnosisError: It is not.
        RecordingError: It cannot be read.
    """
    if isinstance(path, Recording):
        return _require_long(path, f"the recording of joint {path.metadata.joint!r}")
    if joint is None:
        return _require_long(read_recording(Path(path)), f"the recording {os.fspath(path)}")
    simulated = list_joints(Path(simulation)) if isinstance(simulation, str | os.PathLike) else ()
    return _require_long(
        read_recording(Path(path), joint=joint, simulated=simulated), f"the recording {os.fspath(path)}"
    )


def _diagnose(
    series: Sequence[Recording],
    simulation: RigidJoint | str | os.PathLike[str] | None,
    friction: FrictionModel | str | os.PathLike[str] | None,
    simulated: Source | None,
    settings: dict[str, Any],
    error: float | None = None,
) -> Diagnosis:
    """Compare with the simulation that was given as a file, as its own recording, or not at all."""
    if simulated is not None:
        if simulation is not None or friction is not None:
            raise DiagnosisError("simulated is the simulation: leave out simulation and friction")
        settings.pop("payload")
        return diagnose_against(series, read_long_recording(simulated), **settings)
    payload = settings.pop("payload")
    several = len({one.metadata.joint for one in series} - {"", "joint"}) > 1
    if several and settings["joint"] is None and isinstance(simulation, str | os.PathLike):
        return _compare_payloads(series, Path(simulation), settings["names"], payload=payload)
    model = load_model(friction) if isinstance(friction, str | os.PathLike) else friction
    joint = Path(simulation) if isinstance(simulation, str | os.PathLike) else simulation
    return diagnose_joint(series, joint, friction=model, simulation_error=error, **settings)


def _compare_payloads(
    series: Sequence[Recording], simulation: Path, names: Sequence[str], *, payload: bool
) -> Diagnosis:
    """What an arm carries at its end, from two sessions, or from one where that is asked for.

    Raises:
        DiagnosisError: It is one session, and nobody says that it is the payload that is looked for.
    """
    if len(group_sessions(series)) == 1 and not payload:
        raise DiagnosisError(
            "the recordings are one session of an arm: fricomp.examine_arm says what its simulation leaves out, and "
            "payload=True what it carries if the simulation is right; two sessions compare their payloads"
        )
    return diagnose_payload(series, simulation, names)


def _require_long(recording: Recording, name: str) -> Recording:
    if recording.duration < SHORTEST_RECORDING:
        raise DiagnosisError(
            f"{name} lasts {recording.duration:.3g} s, and a diagnosis needs at least {SHORTEST_RECORDING:g} s of "
            "each: record a longer motion, of half a minute and more"
        )
    return recording


def _name_of(source: Source, number: int) -> str:
    return f"recording {number}" if isinstance(source, Recording) else Path(source).stem
