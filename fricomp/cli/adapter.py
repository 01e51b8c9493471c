"""`fricomp adapter`: a careful first trial of a real drive, and clearing its faults."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fricomp.adapters import JointAdapter
    from fricomp.adapters.trial import TrialSettings, TrialStep

app = typer.Typer(add_completion=False)

TAKE_OVER = typer.Option(
    "--take-over",
    help="Stop a drive that somebody else has energised: zero torque, then limp. Without it, such a drive is refused.",
)

MARKS = {True: ("ok", "green"), False: ("failed", "red"), None: ("open", "yellow")}


@app.callback()
def adapter() -> None:
    """Try a real drive, carefully, and clear its faults."""


@app.command(epilog="fricomp adapter check arm.toml --share 0.02\n\nfricomp adapter check arm.toml --listen-only")
def check(
    configuration: Annotated[Path, typer.Argument(help="Configuration file: bus, joints, limits.")],
    share: Annotated[float, typer.Option(help="Largest torque, as a share of the limit; 0.05 or less.")] = 0.05,
    rate: Annotated[float, typer.Option(help="Rate of the control loop [Hz].")] = 200.0,
    motion: Annotated[float, typer.Option(help="Motion that ends a push [rad] or [m].")] = 0.05,
    listen_only: Annotated[bool, typer.Option("--listen-only", help="Energise nothing.")] = False,
    take_over: Annotated[bool, TAKE_OVER] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before energising.")] = False,
) -> None:
    """Open a drive, read what it says, energise it at zero torque, push it gently both ways, and stop it.

    A drive that somebody else has energised is refused; nothing is written to it. The gate itself is cut down to
    the share, so that nothing above it can be commanded. What the drive latches while its watchdog is tried is
    cleared. Exit status 1 if a step fails.
    """
    from dataclasses import asdict

    from fricomp.adapters import open_adapter
    from fricomp.adapters.configuration import read_configuration
    from fricomp.adapters.trial import TrialSettings
    from fricomp.cli.output import answer
    from fricomp.errors import ParameterError

    if not rate > 0.0:
        raise ParameterError(f"the rate must be positive [Hz], got {rate!r}")
    settings = TrialSettings(period=1.0 / rate, share=share, largest_motion=motion, take_over=take_over)
    content = read_configuration(configuration)

    def may_energise() -> bool:
        if listen_only:
            return False
        question = f"Energise the joints, at most {share:.0%} of their torque limits? They may move."
        return yes or typer.confirm(question, err=True)

    steps = _try(open_adapter(content["backend"], content), settings, may_energise)
    failed = any(step.passed is False for step in steps)
    answer({"passed": not failed, "steps": [asdict(step) for step in steps]})
    if failed:
        raise typer.Exit(1)


def _try(adapter: JointAdapter, settings: TrialSettings, may_energise: Callable[[], bool]) -> list[TrialStep]:
    """Go through the steps of a trial, and print each as it ends; Ctrl-C stops the drives."""
    from contextlib import closing

    from rich.text import Text

    from fricomp.adapters.trial import try_drive
    from fricomp.cli.output import say_interrupted
    from fricomp.cli.terminal import console
    from fricomp.control.loop.ending import require_stopped
    from fricomp.control.loop.interruption import interrupting_on_ending_signals

    steps = []
    try:
        with interrupting_on_ending_signals(), closing(try_drive(adapter, settings, may_energise)) as trial:
            for step in trial:
                steps.append(step)
                mark, style = MARKS[step.passed]
                console().print(Text.assemble((f"{mark:<6}", style), f" {step.name}: {step.detail}"), soft_wrap=True)
    except KeyboardInterrupt:
        require_stopped(adapter)
        say_interrupted("; what was energised is at zero torque")
        raise
    return steps


@app.command(epilog="fricomp adapter clear arm.toml\n\nfricomp adapter clear arm.toml --take-over")
def clear(
    configuration: Annotated[Path, typer.Argument(help="Configuration file: bus, joints, limits.")],
    take_over: Annotated[bool, TAKE_OVER] = False,
) -> None:
    """Clear what the drives have latched, once its cause is gone. Energises nothing; a fault that stays is named.

    A drive that somebody else has energised is refused; nothing is written to it.
    """
    from fricomp.adapters import open_adapter
    from fricomp.adapters.configuration import read_configuration
    from fricomp.adapters.trial import describe_energy
    from fricomp.cli.output import answer
    from fricomp.cli.terminal import console

    content = read_configuration(configuration)
    adapter = open_adapter(content["backend"], content)
    try:
        adapter.open(take_over=take_over)
        if adapter.taken_over:
            console().print(f"Taken over, and limp now: {', '.join(adapter.taken_over)}.")
        adapter.clear_faults()
        names = [joint.name for joint in adapter.capabilities.joints]
        energy = describe_energy(names, adapter.read_energised())
    finally:
        adapter.close()
    answer({"joints": names, "taken_over": adapter.taken_over, "energy": energy})
    console().print(f"No fault is left on {', '.join(names)}; {energy}.")
