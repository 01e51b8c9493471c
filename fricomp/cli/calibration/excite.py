"""`fricomp calibrate --excite`: all joints of an arm at once, on a motion that is chosen for what it tells."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricomp.adapters import JointAdapter, open_adapter
from fricomp.arm.motion import Excitation, MotionLimits, design_excitation, record_excitation
from fricomp.arm.motion.recording import ArmController, read_positions
from fricomp.arm.rigid.regressor import compute_regressor
from fricomp.arm.rigid.simulated_arm import SimulatedArm, read_arm
from fricomp.calibration.sweep import CalibrationRequest
from fricomp.cli.terminal import Table, console, progress
from fricomp.control import ArmLoad
from fricomp.control.loop.ending import require_stopped, stopping_on_error
from fricomp.control.loop.interruption import interrupting_on_ending_signals
from fricomp.errors import ParameterError
from fricomp.recording import write_recording
from fricomp.report import Chart, Line, Panel, draw_png
from fricomp.result_kinds import EXCITATION
from fricomp.results import claim_folder, plain_name
from fricomp.whole_file import write_json

if TYPE_CHECKING:
    from fricomp.laws import FloatArray

_SCHEMA = "fricomp.excitation/1"


def excite_arm(
    request: CalibrationRequest, duration: float, seed: int, out: Path, *, dry_run: bool, overwrite: bool
) -> None:
    """Choose a motion of all joints, show it, and where it is no dry run record them on it.

    Raises:
        ParameterError: There is no simulation of the arm, or no motion fits into the limits.
        FricompError: The joints cannot be moved, or `out` holds something else.
    """
    if not request.model:
        raise ParameterError("--excite needs the simulation of the arm: give --model arm.xml (MJCF or URDF)")
    with claim_folder(out, EXCITATION, overwrite=overwrite, inputs=(Path(request.model),)) as claim:
        with _open(request) as adapter:
            names = [joint.name for joint in adapter.capabilities.joints]
            start = read_positions(adapter)
            arm, limits = read_arm(request.model, names), _find_limits(adapter)
            with progress() as bar:
                task = bar.add_task("reading", total=None)

                def say(what: str) -> None:
                    bar.update(task, description=what)

                plan = design_excitation(
                    arm, request.model, limits, start=start, duration=duration, seed=seed, progress=say
                )
                claim.clear()
                _write_plan(plan, names, limits, out, recorded=False)
                _print_plan(plan, names, limits)
                if dry_run:
                    console().print(f"Nothing moved. The motion is drawn in {out / 'excitation.png'}", markup=False)
                    return
                say(f"moving for {duration:g} s")
                load = ArmLoad(request.model, arm.joints)
                controller = ArmController(load, arm.armature.tolist(), _weigh_joints(arm, plan).tolist())
                source = f"fricomp calibrate --excite --seed {seed}"
                recordings = record_excitation(adapter, plan.motion, controller, speed=limits.speed, source=source)
        for one in recordings:
            path = out / "recordings" / f"{plain_name(one.metadata.joint)}.csv"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_recording(one, path)
        _write_plan(plan, names, limits, out, recorded=True)
    console().print(
        f"In {out / 'recordings'}: {len(recordings)} joints, {recordings[0].duration:.4g} s. Examine them by: fricomp "
        f"diagnose {out / 'recordings'} --simulation {request.model} --out {out}-arm",
        soft_wrap=True,
        markup=False,
    )


@contextmanager
def _open(request: CalibrationRequest) -> Iterator[JointAdapter]:
    """The adapter, open; at zero torque and closed at the end, whatever happens."""
    with interrupting_on_ending_signals():
        adapter = open_adapter(request.backend, request.configuration)
        try:
            with adapter, stopping_on_error(adapter):
                yield adapter
        finally:
            require_stopped(adapter)


def _find_limits(adapter: JointAdapter) -> MotionLimits:
    """What the gate lets through, within the ranges of the joints."""
    limits, joints = adapter.gate.limits, adapter.capabilities.joints
    ranges = [one.position or joint.position_limits for one, joint in zip(limits, joints, strict=True)]
    return MotionLimits.from_ranges(ranges, [one.velocity for one in limits], [one.torque for one in limits])


def _weigh_joints(arm: SimulatedArm, plan: Excitation) -> FloatArray:
    """Inertia that each joint moves in the middle of the motion, its rotor included [kg·m²] or [kg]."""
    n = len(arm.joints)
    q, still = np.tile(plan.motion.centre, (n, 1)), np.zeros((n, n))
    moved, held = (compute_regressor(arm, q, still, a) @ arm.inertia.ravel() for a in (np.eye(n), still))
    return np.asarray(np.maximum(np.diag(moved - held) + arm.armature, 1e-6))


def _write_plan(plan: Excitation, names: Sequence[str], limits: MotionLimits, out: Path, *, recorded: bool) -> None:
    motion = plan.motion
    content: dict[str, Any] = {
        "schema": _SCHEMA,
        "joints": list(names),
        "information": plan.information,
        "frequency": motion.frequency,
        "duration": motion.duration,
        "ramp": motion.ramp,
        "centre": motion.centre.tolist(),
        "sine": motion.sine.tolist(),
        "cosine": motion.cosine.tolist(),
        "recorded": recorded,
    }
    write_json(out / "excitation.json", content)
    draw_png(_draw(plan, names, limits), out / "excitation.png")


def _draw(plan: Excitation, names: Sequence[str], limits: MotionLimits) -> Chart:
    time = np.linspace(0.0, plan.motion.duration, 1200)
    position = plan.motion.sample(time)[0]
    ends = time[[0, -1]]
    panels = tuple(
        Panel(
            (
                Line(time, position[:, j], "position"),
                Line(ends, np.full(2, limits.lowest[j]), "lower limit"),
                Line(ends, np.full(2, limits.highest[j]), "upper limit"),
            ),
            title=name,
            x_label="time [s]",
            y_label="[rad] or [m]",
        )
        for j, name in enumerate(names)
    )
    return Chart("excitation", "Motion of all joints", panels, caption="Within their limits.", share_x=True)


def _print_plan(plan: Excitation, names: Sequence[str], limits: MotionLimits) -> None:
    position = plan.motion.sample(np.linspace(0.0, plan.motion.duration, 1200))[0]
    table = Table("joint", "from", "to", "speed", "of its limit", "torque", "of its limit", box=None, pad_edge=False)
    for j, name in enumerate(names):
        fast, strong = plan.speed[j], plan.torque[j]
        table.add_row(
            name,
            f"{position[:, j].min():.3g}",
            f"{position[:, j].max():.3g}",
            f"{fast:.3g}",
            f"{fast / limits.speed[j]:.0%}",
            f"{strong:.3g}",
            f"{strong / limits.torque[j]:.0%}",
        )
    screen = console()
    screen.print(
        f"Excitation of {len(names)} joints for {plan.motion.duration:g} s, after a slow way to its start; expected "
        f"information {plan.information:.4g} nat.",
        markup=False,
    )
    screen.print(table)
    for note in plan.notes:
        screen.print(note, style="yellow", markup=False)
