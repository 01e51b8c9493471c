"""`fricomp calibrate`: sweep a joint, identify its friction, write model, network and report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fricomp.cli.calibration.resume import flags
from fricomp.cli.option.motion_log import LogFile, claim_log
from fricomp.cli.option.page import Live, OpenPages
from fricomp.cli.option.panel import option_under
from fricomp.cli.settings_file import use_settings, write_settings
from fricomp.errors import ParameterError
from fricomp.extras import REPORT, require

if TYPE_CHECKING:
    from fricomp.calibration.sweep import CalibrationRequest
    from fricomp.calibration.sweep.weight import HungWeight
    from fricomp.cli.calibration.start import Shown

app = typer.Typer(add_completion=False)

joint_option = option_under("Joint")
sweep_option = option_under("Sweep")
identification_option = option_under("Identification")
instead_option = option_under("Instead of a sweep")
run_option = option_under("Run")

_EXCITED = 60.0
"""How long --excite moves an arm by default [s]."""


_EXAMPLES = """fricomp calibrate --backend sim --out runs/demo

fricomp calibrate --backend sim --model two_link_arm --joint shoulder --out runs/shoulder

fricomp calibrate --backend canopen --config joint.toml --dry-run

fricomp calibrate --backend canopen --config joint.toml --out runs/elbow --adaptive --accuracy 0.5

fricomp calibrate --backend canopen --config joint.toml --dwell 2 --write-settings sweep.toml

fricomp calibrate --settings sweep.toml --repeats 3 --out runs/elbow

fricomp calibrate --resume --out runs/elbow

fricomp calibrate --backend sim --live --open --log runs/sweep.mcap --out runs/watched

fricomp calibrate --backend sim --model six_joint_arm --excite --dry-run

fricomp calibrate --torque-constant --weight 0.5 --lever 0.25 --backend dynamixel --config joint.toml
"""


@app.command(epilog=_EXAMPLES)
def calibrate(
    context: typer.Context,
    backend: Annotated[
        str | None, joint_option(help="Adapter: `fricomp adapters` lists them; what --config says, or sim.")
    ] = None,
    config: Annotated[Path | None, joint_option(help="Configuration of the adapter (TOML).")] = None,
    joint: Annotated[str, joint_option(help="Joint to calibrate; the first if not given.")] = "",
    model: Annotated[
        str,
        joint_option(
            help="MJCF of the mechanism, for gravity and inertia; of sim: default_joint, two_link_arm or a file."
        ),
    ] = "",
    gravity_unknown: Annotated[
        bool,
        joint_option(
            "--gravity-unknown", help="No model of the gravity on this joint: half difference of both directions."
        ),
    ] = False,
    speeds: Annotated[
        str,
        sweep_option(
            help="log:LOW:HIGH:COUNT, uniform:LOW:HIGH:COUNT or a list [rad/s] or [m/s]; "
            "log-spaced below the highest that fits into the travel if not given."
        ),
    ] = "",
    repeats: Annotated[int, sweep_option(help="Visits to each speed in each direction.")] = 2,
    dwell: Annotated[float, sweep_option(help="Time on a settled plateau [s].")] = 1.0,
    warm_up: Annotated[float, sweep_option(help="Time of moving to and fro before the sweep [s].")] = 8.0,
    positions: Annotated[int, sweep_option(help="Places over the travel at which slow plateaus are centred.")] = 1,
    loop: Annotated[
        Literal["auto", "drive", "host"],
        sweep_option(help="Where the velocity loop runs: in the drive, or here on the host."),
    ] = "auto",
    inertia: Annotated[
        float,
        sweep_option(
            show_default=False,
            help="Inertia about the joint, for the host's loop [kg·m²] or [kg]; that of --model if not given.",
        ),
    ] = 0.0,
    bandwidth: Annotated[float, sweep_option(help="Bandwidth of the host's loop [rad/s].")] = 60.0,
    check_torque: Annotated[
        float, sweep_option(help="Largest torque of the sign check, as a fraction of the torque limit.")
    ] = 0.3,
    seed: Annotated[
        int, sweep_option(help="Seed of the speeds' order, the network's first weights and simulated noise.")
    ] = 0,
    normal_load: Annotated[
        str, identification_option(help="none, transmitted (from the model), or a number.")
    ] = "none",
    method: Annotated[
        Literal["pinn", "least_squares"],
        identification_option(help="How the law is fitted; both ways lead to the same parameters."),
    ] = "pinn",
    noise: Annotated[
        Literal["auto", "relative", "absolute"],
        identification_option(help="How torque noise grows: relative is in proportion to the friction."),
    ] = "auto",
    adaptive: Annotated[
        bool,
        identification_option(
            "--adaptive", help="Sweep again at the most informative speeds, until --accuracy is reached."
        ),
    ] = False,
    accuracy: Annotated[
        float, identification_option(help="Mean standard deviation at which --adaptive stops [%].")
    ] = 0.5,
    motion: Annotated[
        Path | None, instead_option(help="Record this motion (CSV: time, velocity[, position]) instead, in SI units.")
    ] = None,
    excite: Annotated[
        bool,
        instead_option(
            "--excite", help="Move all joints of an arm (--model) at once, on a motion chosen for what it tells."
        ),
    ] = False,
    duration: Annotated[float, instead_option(help="Length of the motion of --excite [s].")] = _EXCITED,
    torque_constant: Annotated[
        bool, instead_option("--torque-constant", help="Hang a known weight to find the newton metres of a reading.")
    ] = False,
    weight: Annotated[
        float, instead_option(show_default=False, help="Mass that is hung for --torque-constant [kg].")
    ] = 0.0,
    lever: Annotated[
        float, instead_option(show_default=False, help="Distance from the axis to where it hangs [m].")
    ] = 0.0,
    out: Annotated[Path, run_option(help="Folder of the run.")] = Path("runs/calibration"),
    settings: Annotated[
        Path | None,
        run_option(
            is_eager=True,
            callback=use_settings,
            help="TOML file with any options of the headings above; the command line wins.",
        ),
    ] = None,
    write: Annotated[
        Path | None, run_option("--write-settings", help="Write such a file, with comments, and exit; nothing moves.")
    ] = None,
    dry_run: Annotated[
        bool, run_option("--dry-run", help="Print the plan and what it can tell; nothing moves.")
    ] = False,
    overwrite: Annotated[bool, run_option("--overwrite", help="Replace the run that --out holds already.")] = False,
    resume: Annotated[bool, run_option("--resume", help="Continue the run in --out with its own options.")] = False,
    log: LogFile = None,
    live: Live = False,
    open_report: OpenPages = False,
) -> None:
    """Sweep a joint, identify its friction, and write model, network and report.

    The joint first moves by a hair at low torque, to see that signs and scales are right. Ctrl-C stops it at zero
    torque at any time; what was recorded stays, and --resume continues it: --method, --noise and --normal-load
    may then be given anew.
    """
    from fricomp.api.calibrate import adapter_configuration
    from fricomp.calibration.sweep import CalibrationOptions, CalibrationRequest, IdentificationSettings, SweepSettings
    from fricomp.calibration.sweep.weight import HungWeight
    from fricomp.cli.calibration.start import Shown, resume_run
    from fricomp.cli.terminal import console

    given = _given(context)
    if write is not None:
        write_settings(context, write, overwrite=overwrite)
        console().print(f"Written: {write}. Edit it, and give it as --settings {write}", soft_wrap=True)
        return
    _refuse_contradictions(given)
    if not (dry_run or torque_constant or motion or excite):
        require(*REPORT, "onnx")
    swept = SweepSettings(
        speeds=speeds, repeats=repeats, dwell=dwell, warm_up=warm_up, positions=positions,
        loop=loop, inertia=inertia, bandwidth=bandwidth, check_torque=check_torque, seed=seed,
    )  # fmt: skip
    options = CalibrationOptions(
        IdentificationSettings(method=method, noise=noise, seed=seed),
        normal_load=normal_load, gravity_unknown=gravity_unknown, adaptive=adaptive, accuracy=0.01 * accuracy,
    )  # fmt: skip
    chosen, file = adapter_configuration(backend, config, model, seed)
    mechanism = "" if gravity_unknown else file
    wanted = "" if motion is None else str(motion)
    request = CalibrationRequest(*chosen, joint, mechanism, swept, options, wanted)
    if excite:
        from fricomp.cli.calibration.excite import excite_arm

        excite_arm(request, duration, seed, out, dry_run=dry_run, overwrite=overwrite)
        return
    hung = HungWeight(weight, lever) if torque_constant else None
    shown = Shown(live, open_report, log)
    with claim_log(log, overwrite=overwrite):
        if resume:
            resume_run(out, request, set(given) - {"resume", "out"} - _list_output(context), shown)
        elif dry_run:
            _print_plan(request, hung)
        else:
            _move(request, hung, out, shown, overwrite=overwrite)


def _print_plan(request: CalibrationRequest, hung: HungWeight | None) -> None:
    """What each mode would do; nothing moves."""
    from fricomp.cli.calibration.plan import print_motion_plan, print_sweep_plan, print_torque_constant_plan

    if hung is not None:
        print_torque_constant_plan(request, hung)
    elif request.motion:
        print_motion_plan(request)
    else:
        print_sweep_plan(request)


def _move(request: CalibrationRequest, hung: HungWeight | None, out: Path, shown: Shown, *, overwrite: bool) -> None:
    """From here on the joint moves."""
    from fricomp.cli.calibration.start import record_file, start_run
    from fricomp.cli.calibration.torque_constant import measure_torque_constant

    if hung is not None:
        measure_torque_constant(request, hung, out, overwrite=overwrite)
    elif request.motion:
        record_file(request, out, shown, overwrite=overwrite)
    else:
        start_run(request, out, shown, overwrite=overwrite)


_GIVEN = ("COMMANDLINE", "DEFAULT_MAP")


def _given(context: typer.Context) -> dict[str, Any]:
    """The options that stand on the command line, or in the file of --settings."""
    sources = {name: context.get_parameter_source(name) for name in context.params}
    return {name: context.params[name] for name, source in sources.items() if source and source.name in _GIVEN}


def _list_output(context: typer.Context) -> set[str]:
    """Names of the options that say how to answer, which change nothing of a run."""
    return {str(one.name) for one in context.command.params if getattr(one, "rich_help_panel", None) == "Output"}


def _refuse_contradictions(given: dict[str, Any]) -> None:
    """Options that belong to another way of moving the joint than the one that was asked for.

    Raises:
        ParameterError: There are some.
    """
    weights = [name for name in ("weight", "lever") if given.get(name)]
    if given.get("torque_constant") and "motion" in given:
        raise ParameterError("--torque-constant has a motion of its own: leave out --motion")
    if given.get("log") and (given.get("torque_constant") or given.get("motion")):
        raise ParameterError("--log is of sweeps, whose model it shows: leave it out, or leave out the other motion")
    if given.get("torque_constant") and given.get("live"):
        raise ParameterError("--live shows sweeps and motions: leave it out with --torque-constant")
    alone = ("motion", "torque_constant", "resume", "joint", "adaptive", "live", "log")
    others = [name for name in alone if given.get(name)]
    if given.get("excite") and others:
        raise ParameterError(
            f"{flags(others)} has no use with --excite, which records all joints on a motion of its own"
        )
    if given.get("duration", _EXCITED) != _EXCITED and not given.get("excite"):
        raise ParameterError("--duration belongs to --excite: give that too, or leave it out")
    if weights and not given.get("torque_constant"):
        raise ParameterError(f"{flags(weights)} belongs to --torque-constant: give that too, or leave it out")
