"""The loop closed: calibrate, compensate, record, diagnose, compensate with what the diagnosis adds.

The joint has friction from its load and cogging that nobody has told the calibration of.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from fricomp.calibration.sweep import (
    CalibrationOptions,
    CalibrationRequest,
    IdentificationSettings,
    RigidBody,
    RunFolder,
    SweepContext,
    SweepSettings,
    calibrate,
)
from fricomp.control import Compensator, ControlLoop, ReferenceState, SineReference
from fricomp.control.loop.loop_log import LoopLog
from fricomp.control.loop.position_loop import Reference
from fricomp.diagnosis import Diagnosis, diagnose, save_diagnosis
from fricomp.errors import DiagnosisError
from fricomp.joint import JointFeedback
from fricomp.model import FrictionModel, save_model
from fricomp.recording import Recording, RecordingMetadata, write_recording

from ...stand_in import SimulatedJointAdapter, StandInSettings
from .case import TrackingFigures, Witness, compute_figures
from .joint import PERIOD, loop_of
from .vertical_joint import GravityController, MultiSine, vertical_joint

CloseLoopMethod = Literal["none", "stribeck", "extended"]
"""Without compensation; with the calibrated model; with what the diagnosis made of it."""

_FREQUENCY, _AMPLITUDE, _CYCLES = 0.1, 0.5, 2.0  # of the sine that is tracked [Hz], [rad]
_RECORDED = MultiSine(((-1.2, 0.05), (0.4, 0.17), (0.1, 0.6)))
_RECORDING_BANDWIDTH = 5.0  # [Hz]


@dataclass(frozen=True)
class CloseLoopResult:
    """What came of it.

    Attributes:
        settings: The joint.
        calibrated: Friction that the sweep found.
        diagnosis: Of a recording of the joint, compensated with it.
        extended: Friction with what the diagnosis adds.
        figures: Tracking, by bandwidth of the PD loop [Hz] and method.
    """

    settings: StandInSettings
    calibrated: FrictionModel
    diagnosis: Diagnosis
    extended: FrictionModel
    figures: dict[float, dict[CloseLoopMethod, TrackingFigures]]


def close_loop(
    folder: Path,
    *,
    bandwidths: Sequence[float] = (5.0, 10.0),
    recorded: float = 24.0,
    sweep: SweepSettings | None = None,
    progress: Callable[[str], None] | None = None,
) -> CloseLoopResult:
    """Go the whole way and leave mechanism, models, recording and diagnosis in `folder`.

    Args:
        folder: Made if it is not there.
        bandwidths: Of the PD loops that are compared [Hz].
        recorded: Length of the recording that is diagnosed [s].
        sweep: Of the calibration; its defaults if None.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: The diagnosis adds nothing to the model.
    """
    say = progress or (lambda _: None)
    folder.mkdir(parents=True, exist_ok=True)
    settings = vertical_joint(folder)
    say("calibrating")
    calibrated = _calibrate(settings, folder / "calibration", sweep or SweepSettings())
    save_model(calibrated, folder / "calibrated.json")
    say("recording with compensation")
    recording, largest_load = _record(vertical_joint(folder, position=_RECORDED.start), calibrated, recorded)
    write_recording(recording, folder / "recording.csv")
    diagnosis = diagnose(recording, settings.mjcf, joint="joint", friction=calibrated, progress=progress)
    save_diagnosis(diagnosis, folder / "diagnosis.json")
    extended = _extend(calibrated, diagnosis, largest_load)
    save_model(extended, folder / "extended.json")
    say("tracking")
    models: dict[CloseLoopMethod, FrictionModel | None] = {
        "none": None,
        "stribeck": calibrated,
        "extended": extended,
    }
    figures = {
        bandwidth: {method: _track(settings, model, bandwidth) for method, model in models.items()}
        for bandwidth in bandwidths
    }
    return CloseLoopResult(settings, calibrated, diagnosis, extended, figures)


def _calibrate(settings: StandInSettings, folder: Path, sweep: SweepSettings) -> FrictionModel:
    options = CalibrationOptions(IdentificationSettings(method="least_squares"))
    request = CalibrationRequest("sim", {}, "joint", str(settings.mjcf), sweep, options)
    with SimulatedJointAdapter(settings) as adapter:
        context = SweepContext(adapter, 0, sweep, RigidBody(settings.mjcf, ["joint"]))
        done = calibrate(context, RunFolder.create(folder, request, overwrite=True), options)
    return done.estimate.result.model


def _record(settings: StandInSettings, model: FrictionModel, duration: float) -> tuple[Recording, float]:
    """A motion over the range of positions and loads, and the largest load of it [N·m]."""
    log, _ = _run(settings, model, _RECORDING_BANDWIDTH, _RECORDED, duration)
    metadata = RecordingMetadata(joint="joint", torque_kind="measured", position_limits=(-2.6, 2.6))
    state, load = ReferenceState(1), [0.0]
    loads = []
    for time in np.arange(0.0, duration, 0.01):
        _RECORDED.sample(float(time), state)
        _make_controller(settings, _RECORDING_BANDWIDTH).load_into(load, JointFeedback(1), state)
        loads.append(abs(load[0]))
    return log.recording(0, metadata), max(loads)


def _extend(calibrated: FrictionModel, diagnosis: Diagnosis, largest_load: float) -> FrictionModel:
    """The extended model of the diagnosis, valid where the calibration and the recording were."""
    found = diagnosis.extended_model
    if found is None:
        raise DiagnosisError(f"the diagnosis adds nothing to the model: {' '.join(diagnosis.sentences)}")
    validity = replace(found.validity, velocity=calibrated.validity.velocity, load_torque=(-largest_load, largest_load))
    return replace(found, validity=validity)


def _track(settings: StandInSettings, model: FrictionModel | None, bandwidth: float) -> TrackingFigures:
    log, position = _run(
        settings, model, bandwidth, SineReference([_AMPLITUDE], _FREQUENCY, [0.0]), _CYCLES / _FREQUENCY
    )
    return compute_figures(log, position, _FREQUENCY)


def _run(
    settings: StandInSettings, model: FrictionModel | None, bandwidth: float, reference: Reference, duration: float
) -> tuple[LoopLog, list[float]]:
    """The log, and the true position at each of its cycles [rad]."""
    _, loop = loop_of(bandwidth, settings.joints[0].sensor)
    # Of any status: what is concealed may hide a Stribeck effect, and the curve is still what was measured.
    compensator = None if model is None else Compensator(model, period=PERIOD, loop=loop, any_status=True)
    with SimulatedJointAdapter(settings) as adapter:
        controller = _make_controller(settings, bandwidth)
        witness = Witness(controller, adapter)
        result = ControlLoop(
            adapter,
            reference,
            witness,
            compensators=None if compensator is None else [compensator],
            load_model=controller,
            period=PERIOD,
        ).run(duration)
    result.raise_if_tripped()
    return result.log, witness.position


def _make_controller(settings: StandInSettings, bandwidth: float) -> GravityController:
    return GravityController(loop_of(bandwidth, settings.joints[0].sensor)[0])
