"""`fricomp calibrate --torque-constant`: a known weight tells what a reading of torque is in newton metres."""

from dataclasses import asdict, replace
from pathlib import Path

import typer
from rich.text import Text

from fricomp.calibration.identification.report.chart import REACH
from fricomp.calibration.sweep import CalibrationRequest, open_joint
from fricomp.calibration.sweep.weight import HungWeight, TorqueConstant, identify_torque_constant, record_passes
from fricomp.cli.calibration.start import follow
from fricomp.cli.output import answer
from fricomp.cli.terminal import console, progress
from fricomp.recording import Recording, write_recording
from fricomp.result_kinds import TORQUE_CONSTANT
from fricomp.results import claim_folder
from fricomp.whole_file import write_json

__all__ = ["measure_torque_constant"]

N_PASSES = 4

_RESULT = "torque_constant.json"


def measure_torque_constant(request: CalibrationRequest, weight: HungWeight, out: Path, *, overwrite: bool) -> None:
    """Move the joint without and with the weight, and write what that says; a simulated joint hangs it by itself.

    Raises:
        ParameterError: The folder cannot be made.
        OutputError: It holds such a measurement that is not to be replaced, or files of somebody else.
    """
    with claim_folder(out, TORQUE_CONSTANT, overwrite=overwrite) as claim:
        with open_joint(request) as context:
            simulated = context.adapter.capabilities.simulated
            gear_ratio = context.adapter.options.gears[context.joint].gear_ratio
        claim.clear()  # left there, they would pass for what an interrupted one has found
        bare = _record(request, weight, out, simulated=simulated, hung=False)
        loaded = _record(request, weight, out, simulated=simulated, hung=True)
        found = identify_torque_constant(bare, loaded, weight, gear_ratio)
        write_json(out / _RESULT, found)
    _print(found, out)


def _record(
    request: CalibrationRequest, weight: HungWeight, out: Path, *, simulated: bool, hung: bool
) -> tuple[Recording, ...]:
    name = "loaded" if hung else "bare"
    if simulated:
        from fricomp.sim_bench.twins.weight import hang_weight

        mass = weight.mass if hung else 0.0
        file = out / f"{name}.xml"
        table = hang_weight(request.backend, request.configuration, request.joint, (mass, weight.lever), file)
        request = replace(request, configuration=table, model="")
    else:
        wanted = f"Hang {weight.mass:g} kg at {weight.lever:g} m from the axis" if hung else "Take the weight off"
        typer.prompt(
            f"{wanted}; the joint then moves slowly over its travel. Enter goes on", default="", prompt_suffix=""
        )
    with open_joint(request) as context, progress() as bar:
        passes = record_passes(context, N_PASSES, follow(bar))
    for number, samples in enumerate(passes):
        write_recording(samples, out / f"{name}-{number}.csv")
    return passes


def _print(found: TorqueConstant, out: Path) -> None:
    unit, reach = found.unit, REACH * found.deviation
    answer({**asdict(found), "file": out / _RESULT})
    screen = console()
    screen.print(
        Text.assemble(
            f"Gravity reads up to {found.bare:.4g} {unit} without the weight, which adds {found.added:.4g} {unit}: ",
            (f"1 {unit} of the reading is {found.value:.5g} ± {reach:.1g} N·m", "bold"),
            " on the joint (± 95 %, not counting how well weight and lever are known).",
        )
    )
    if unit in ("N·m", "N"):
        screen.print(
            "The drive reads in N·m already: a factor other than 1 is an error of its torque constant or rated torque; "
            "correct it there."
        )
    else:
        screen.print(f"Put torque_constant = {found.at_drive:.5g} into the joint's table, and everything is in N·m.")
        if found.gear_ratio != 1.0:
            screen.print(f"That is at the drive: through its gear of {found.gear_ratio:g} it makes the number above.")
    screen.print(Text.assemble("In ", (str(out), "bold"), ": torque_constant.json, recordings of every pass"))
