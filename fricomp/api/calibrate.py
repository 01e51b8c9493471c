"""`fricomp.calibrate`: sweep a joint, identify its friction, and write the folder of the run where one is wanted."""

from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fricomp.adapters.configuration import AdapterChoice, choose_adapter
from fricomp.calibration.sweep import (
    Calibration,
    CalibrationOptions,
    CalibrationRequest,
    RunFolder,
    SweepSettings,
    SweepWatch,
    check_feasible,
    open_joint,
    write_run,
)
from fricomp.calibration.sweep import calibrate as sweep_joint
from fricomp.extras import REPORT, require

Progress = Callable[[str, float], None]


def calibrate(
    backend: str | None = None,
    *,
    config: str | Path | Mapping[str, Any] | None = None,
    joint: str = "",
    model: str = "",
    settings: SweepSettings | None = None,
    options: CalibrationOptions | None = None,
    out: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Calibration:
    """Move a joint through a bidirectional velocity sweep and identify the friction that it shows; the joint moves.

    At a constant velocity v nothing accelerates, so that what the drive gives less gravity is friction:

        tau_friction(v) = mean(tau) - tau_gravity(q),

    measured on plateaus at many speeds in both directions, slow and fast ones shuffled so that warming up is no trend.
    Over the points a Stribeck curve is identified for each direction, with the covariance of its parameters:

        tau(v) = sign(v) (F_c + (F_s - F_c) exp(-(v / v_s)²)) + sigma_2 v.

    The joint first moves by a hair at low torque, to see that signs and scales are right. It ends at zero torque,
    however this call ends: by itself, by an error, by Ctrl-C.

    Args:
        backend: Name of the adapter, such as `canopen`; `fricomp adapters` lists them. What `config` says if None, or
            `sim`, the simulated joint, which needs no hardware.
        config: Configuration of the adapter: a TOML file, or the table that it would hold.
        joint: Name of the joint to calibrate; the first one if empty.
        model: MJCF file of the mechanism. Give it where gravity acts on the joint or it belongs to an arm: its gravity
            is taken off, and its inertia sets the gains of the host's loop. Of `sim`: `default_joint`,
            `two_link_arm` or a file. Without a model say `CalibrationOptions(gravity_unknown=True)` where gravity acts:
            friction is then half the difference of both directions, and the same in both.
        settings: Of the sweep. Change `speeds` where the highest speed of the travel is not that of the task, and raise
            `repeats` or `dwell` where the intervals of the parameters are too wide: they shrink with the square root.
        options: What is made of the sweep. `adaptive=True` adds plateaus at the speeds that tell most, until the mean
            standard deviation is below `accuracy`.
        out: Folder of the run, as the command writes it: recording, model, network, report. Nothing is kept if None.
        overwrite: Replace the run that `out` holds already.
        progress: Called with what is being done and how far it is [0 to 1].

    Raises:
        ParameterError: A setting is outside its range, the sweep cannot be done, or the backend has no such joint.
        AdapterError: The drive cannot be reached or used; or the last stop did not get through.
        SweepAborted: The sweep was stopped, or `out` holds a run already.
        IdentificationError: The points do not determine friction.
        MissingExtraError: A package is not installed; the message names the extra that brings it.
    """
    chosen, options = settings or SweepSettings(), options or CalibrationOptions()
    adapter, mechanism = adapter_configuration(backend, config, model, chosen.seed)
    request = CalibrationRequest(*adapter, joint, "" if options.gravity_unknown else mechanism, chosen, options)
    if out is not None:
        require(*REPORT, "onnx")  # before the joint moves for minutes
        calibration, folder = record_sweep(request, Path(out), overwrite=overwrite, progress=progress)
        write_run(calibration, folder)
        return calibration
    with TemporaryDirectory(prefix="fricomp-") as kept:
        return record_sweep(request, Path(kept), progress=progress)[0]


def record_sweep(
    request: CalibrationRequest,
    out: Path,
    *,
    overwrite: bool = False,
    progress: Progress | None = None,
    watch: SweepWatch | None = None,
) -> tuple[Calibration, RunFolder]:
    """Sweep the joint of a request into a folder and identify its friction; the joint is closed afterwards.

    Args:
        request: What is asked for.
        out: The folder.
        overwrite: Replace the run that it holds already.
        progress: As for `calibrate`.
        watch: Is shown the joint and what the sweep records.

    Raises:
        FricompError: See `calibrate`; what was recorded stays in the folder.
    """
    with open_joint(request, watch) as context:
        check_feasible(context, request.options)  # before an earlier run is thrown away
        folder = RunFolder.create(out, request, overwrite=overwrite)
        return sweep_joint(context, folder, request.options, progress or _report_nothing), folder


def adapter_configuration(
    backend: str | None, config: str | Path | Mapping[str, Any] | None, model: str, seed: int
) -> tuple[AdapterChoice, str]:
    """The adapter with what it is made from, and the MJCF file of the mechanism.

    The simulated joint is its own mechanism: `model` chooses it, and its file says what gravity and inertia are.

    Raises:
        AdapterConfigurationError: The file cannot be read, or says another backend.
    """
    chosen = choose_adapter(backend, config)
    if chosen.backend != "sim":
        return chosen, model
    from fricomp.sim_bench.stand_in import PACKAGED_MODELS, packaged_model

    name = model or chosen.configuration.get("model", "default_joint")
    chosen = AdapterChoice("sim", {"seed": seed, **chosen.configuration, "model": name})
    return chosen, str(packaged_model(name)) if name in PACKAGED_MODELS else name


def _report_nothing(text: str, done: float) -> None:
    pass
