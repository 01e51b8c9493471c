"""One evaluator: how well a model, as it is written in its file, predicts a recording."""

from collections.abc import Sequence

from fricomp.blas import one_blas_thread
from fricomp.errors import RecordingError
from fricomp.model import FrictionModel
from fricomp.model.given import take_model
from fricomp.recording import Recording, read_recording
from fricomp.recording.file import take_recording

from .errors import Spans, measure_positions, summarise_torque
from .evaluated import EvaluatedJoint, JointAlong
from .motion import RecordedMotion, read_motion
from .reading import Source, read_model
from .result import Evaluation, PositionError, TorqueError
from .settings import HORIZONS


@one_blas_thread()
def evaluate(
    model: FrictionModel | Source,
    recording: Recording | Source,
    *,
    simulation: Source | None = None,
    joint: str | None = None,
    spans: Spans | None = None,
    band: float | None = None,
) -> Evaluation:
    """Measure the errors of a model over a recording, in the units that its user thinks in.

    Two errors are measured. The torque error is recorded torque less that of the model along the recorded motion,
    both through the same low-pass, where the joint moves. The position error is that of an open-loop simulation,
    driven by the recorded torque from many measured states: a joint equation J a = tau - friction - gravity for a
    friction model, MuJoCo for an MJCF or URDF file.

    Give a recording, or `spans` of one, that the fit did not see: on its own data every model looks good.

    Args:
        model: A friction model, its file (`friction.json`, `.onnx`), an MJCF or URDF file, or the folder of a
            diagnosis or calibration, whose `friction.json` is taken.
        recording: A recording, or its file.
        simulation: MJCF or URDF file whose inertia and gravity go with a friction model that has none of its own.
        joint: Name of the joint in the MJCF or URDF file; needed where there are several and none has the recording's.
        spans: Times from and to which errors count [s], such as those that were held out; all if None.
        band: Upper end of the band of the torque error [Hz]; the widest in which the motion is known if None.

    Raises:
        ModelFileError: The model cannot be read, or says nothing of inertia and gravity, and no simulation does.
        RecordingError: The recording cannot be read, is too short, never moves, or is in another unit.
        SimulationFileError: The simulation cannot be read, or has no such joint.
    """
    source = take_model(model)
    taken = take_recording(recording)
    series = (taken if isinstance(taken, Recording) else read_recording(taken)).on_joint_side()
    _require_time(series, spans)
    read = read_model(source, simulation=simulation, joint=joint or series.metadata.joint, named=joint is not None)
    return evaluate_joint(read, series, spans=spans, band=band)


def evaluate_joint(
    model: EvaluatedJoint,
    recording: Recording,
    *,
    spans: Spans | None = None,
    band: float | None = None,
    motion: RecordedMotion | None = None,
    positions: bool = True,
) -> Evaluation:
    """Measure the errors of a model that was read already.

    Args:
        model: From `read_model`.
        recording: Its torque on the side of the joint.
        spans: Times that count [s]; all if None.
        band: Upper end of the band [Hz]; chosen if None.
        motion: The recording as it was read for another model; None to read it.
        positions: Whether to simulate as well.

    Raises:
        RecordingError: The recording is too short, never moves, or is in another unit than the model.
    """
    _require_unit(model, recording)
    motion = motion or read_motion(recording, band=band)
    along = JointAlong(model, motion)
    torque = summarise_torque(motion, [along.compare_torque(spans)])
    found = measure_positions(motion, along.simulate, spans) if positions else ()
    notes = (*model.notes, *_describe_motion(motion))
    if positions:
        notes += tuple(_describe_position(found))
    return Evaluation(model.name, torque, found, (*notes, *_warn(torque, found)))


def _require_time(recording: Recording, spans: Spans | None) -> None:
    """Refuse times of which none is in the recording.

    Raises:
        RecordingError: A time ends before it begins, or none has a sample.
    """
    first, last = float(recording.time[0]), float(recording.time[-1])
    for start, stop in spans or ():
        if not start < stop:
            raise RecordingError(f"the time from {start:g} to {stop:g} s holds nothing: its end has to come later")
    if spans and all(start > last or stop <= first for start, stop in spans):
        raise RecordingError(f"the recording lasts from {first:g} to {last:g} s, and has nothing in the time asked for")


def _describe_position(found: Sequence[PositionError]) -> list[str]:
    if found:
        return []
    return [f"No position errors: the time is too short for runs of {HORIZONS[0]:g} s from many starts."]


def _warn(torque: TorqueError, found: Sequence[PositionError]) -> list[str]:
    """That a model is no better than none, which its figures alone say to those who know what they mean."""
    said = []
    if torque.rms > torque.recorded:
        said.append(f"misses {torque.rms:.3g} {torque.unit} of a torque of {torque.recorded:.3g} {torque.unit}")
    if found and found[0].median > found[0].travel:
        said.append(
            f"is off by {found[0].median:.3g} {found[0].unit} after {found[0].after:g} s, in which the joint "
            f"moved by {found[0].travel:.3g} {found[0].unit}"
        )
    if not said:
        return []
    return [
        f"Careful: this model {' and '.join(said)}: it is no better than none. Is it of this joint, and in its "
        "units and signs?"
    ]


def _require_unit(model: EvaluatedJoint, recording: Recording) -> None:
    metadata = recording.metadata
    if (model.motion, model.torque_unit) != (metadata.motion, metadata.torque_unit):
        raise RecordingError(
            f"the model is of a {model.motion} joint in {model.torque_unit}, the recording of a {metadata.motion} one "
            f"in {metadata.torque_unit}: give a recording in the model's unit, by scale and torque_unit in a mapping "
            "('fricomp convert LOG --inspect --out log.toml' begins one, 'fricomp convert LOG --mapping log.toml --out "
            "FILE.csv' makes it)"
        )


def _describe_motion(motion: RecordedMotion) -> tuple[str, ...]:
    notes = []
    if motion.parts[0].channels.get("load_torque") is not None:
        notes.append("Terms that follow the load take the recorded load torque.")
    how = "recorded" if motion.velocity_recorded else "estimated from the position"
    notes.append(f"Velocities of the starting states are {how}.")
    return tuple(notes)
