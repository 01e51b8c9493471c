"""What the compensator and the gate cost, in units of one bare Stribeck curve in pure `math`."""

import math
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from fricomp.control import ArmCompensator, ArmLoad, Compensator, JointLimits, SafetyGate
from fricomp.control.compensation.network import NetworkCompensator
from fricomp.export import render_c_header
from fricomp.joint import JointFeedback
from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, LoadCoulomb, LuGre
from fricomp.model import FrictionModel, Validity

from ...stand_in import DEFAULT_LAW
from .unit import call_unit, time_beside_unit

__all__ = [
    "N_JOINTS",
    "Cost",
    "bench_model",
    "measure_c",
    "measure_costs",
    "measure_growth",
    "measure_import_ratio",
    "measure_network",
]

N_JOINTS = 7
"""Joints of the arm that is timed."""


@dataclass(frozen=True)
class Cost:
    """Time of one call.

    Attributes:
        name: What was called.
        seconds: Median over the repeats of the mean time of a call [s].
        units: Median over the repeats of its ratio to the bare Stribeck curve timed beside it [1].
        limit: Units it is to stay under; None where none is set.
    """

    name: str
    seconds: float
    units: float
    limit: float | None = None


def bench_model() -> FrictionModel:
    """Table I of [luo2024pinn], with ranges, so that fade and load bounds are at work."""
    return FrictionModel(DEFAULT_LAW, validity=Validity(velocity=(-1.0, 1.0), normal_load=(0.5, 2.0)))


def full_compensator() -> Compensator:
    """Every feature that a static model uses: blend, assistance of both kinds, fade, load, gain, all limits."""
    return Compensator(
        bench_model(),
        source="blend",
        measured_share=0.5,
        torque_rate=1000.0,
        rest_velocity=0.002,
        error_rate=1.0,
        error_band=1e-3,
    )


def measure_costs(calls: int) -> list[Cost]:
    """Time compensator and gate, `calls` at a time, each beside the unit."""
    full, plain = full_compensator().torque, Compensator(bench_model(), source="reference").torque
    law = FrictionLaw((*DEFAULT_LAW.terms, LoadCoulomb(0.1), Cogging(0.05, 0.02, 11.0)))
    more = Compensator(replace(bench_model(), law=law)).torque

    curve = DEFAULT_LAW.terms[0]
    assert isinstance(curve, BidirectionalStribeck)
    bristle = replace(bench_model(), law=FrictionLaw((LuGre(curve.forward, curve.reverse, 6000.0, 5.0),)))
    bent = Compensator(bristle, source="reference").torque

    def extended() -> float:
        return more(0.03, 0.029, position=0.3, load_torque=2.0)

    return [
        _cost("bare Stribeck", call_unit, calls, None),
        _cost("compensator, reference only", lambda: plain(0.03), calls, 2.6),
        _cost("compensator, every feature", lambda: full(0.03, 0.029, 0.002, 1.2), calls, 5.0),
        _cost("compensator, load and cogging beside the curve", extended, calls, 6.0),
        _cost("compensator, LuGre", lambda: bent(0.03), calls, 6.0),
        _cost("seven joints as chosen by default, safety gate", _seven_with_gate(False), calls // 5, 50.0),
        _cost("seven joints, every feature, safety gate", _seven_with_gate(True), calls // 5, 50.0),
        _cost("seven joints, friction under load from their arm's dynamics", _seven_under_load(), calls // 5, 60.0),
    ]


def _cost(name: str, call: Callable[[], object], calls: int, limit: float | None) -> Cost:
    return Cost(name, *time_beside_unit(call, calls), limit)


def _seven_with_gate(every_feature: bool = True) -> Callable[[], None]:
    """Compensation of seven joints, then the gate's look at feedback and command.

    Args:
        every_feature: All features and inputs, or the default with reference and measured velocity.
    """
    make = full_compensator if every_feature else lambda: Compensator(bench_model())
    arm = ArmCompensator([make() for _ in range(N_JOINTS)])
    gate = SafetyGate([JointLimits(5.0, 1000.0, 10.0, (-3.0, 3.0), 90.0)] * N_JOINTS, period=1e-3, ramp_time=0.0)
    feedback = JointFeedback(N_JOINTS)
    feedback.position[:], feedback.velocity[:] = [0.1] * N_JOINTS, [0.029] * N_JOINTS
    feedback.temperature[:] = [40.0] * N_JOINTS  # a gate with a limit on it trips where it is not told
    reference, error, load, out = [0.03] * N_JOINTS, [0.002] * N_JOINTS, [1.2] * N_JOINTS, [0.0] * N_JOINTS
    wanted, now = [0.0] * N_JOINTS, 1_000_000_000
    gate.arm(now)

    def tick() -> None:
        nonlocal now
        now += 1_000_000
        feedback.time_ns = now
        gate.observe(feedback, now)
        if every_feature:
            arm.torque_into(wanted, reference, feedback.velocity, error, load)
        else:
            arm.torque_into(wanted, reference, feedback.velocity)
        if not gate.admit(wanted, out, now):
            gate.raise_if_tripped()  # what a closed gate costs is of no interest

    return tick


def _seven_under_load() -> Callable[[], None]:
    """Compensation of seven joints that follows the load, which is computed in the same call."""
    law = FrictionLaw((*DEFAULT_LAW.terms, LoadCoulomb(0.1)))
    arm = ArmCompensator([Compensator(replace(bench_model(), law=law)) for _ in range(N_JOINTS)], _seven_links())
    reference, velocity, error = [0.03] * N_JOINTS, [0.029] * N_JOINTS, [0.002] * N_JOINTS
    position, acceleration, out = [0.1 * j for j in range(N_JOINTS)], [0.2] * N_JOINTS, [0.0] * N_JOINTS
    return lambda: arm.torque_into(out, reference, velocity, error, None, position, acceleration)


def _seven_links() -> ArmLoad:
    """Seven links, each turned by a quarter about the one before."""
    body = (
        '<body pos="0 0 0.15" quat="1 1 0 0"><inertial pos="0.01 0.02 0.1" mass="1.5" diaginertia="0.02 0.02 0.01"/>'
        '<joint axis="0 0 1" name="joint_{}"/>'
    )
    chain = "".join(body.format(j + 1) for j in range(N_JOINTS)) + N_JOINTS * "</body>"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.xml"
        path.write_text(f"<mujoco><worldbody>{chain}</worldbody></mujoco>")
        return ArmLoad(path)


def measure_network(folder: Path, calls: int) -> list[Cost]:
    """Time seven different networks in one graph; needs onnx and onnxruntime.

    Args:
        folder: Where the networks are written.
        calls: Calls at a time.
    """
    from fricomp.calibration.network import save_network
    from fricomp.calibration.network.architecture import LAYER_SIZES, Layer, TanhNetwork
    from fricomp.export import save_graph, stack_networks

    rng, paths = np.random.default_rng(0), []
    for joint in range(N_JOINTS):
        shapes = pairwise(LAYER_SIZES)
        layers = tuple(Layer(rng.normal(size=(n, m)) / math.sqrt(m), rng.normal(size=n)) for m, n in shapes)
        paths.append(folder / f"joint_{joint}.onnx")
        save_network(TanhNetwork(layers, 1.0, 0.5), paths[-1], {})
    save_graph(stack_networks(paths), folder / "arm.onnx")
    network = NetworkCompensator(folder / "arm.onnx", velocity_range=(-1.0, 1.0), largest_share=math.inf)
    out, reference = [0.0] * N_JOINTS, [0.03 * (j + 1) for j in range(N_JOINTS)]
    return [
        _cost("ONNX, seven networks, the graph alone", network.run_graph, calls, None),
        _cost(
            "ONNX, seven networks in one graph, limits included",
            lambda: network.torque_into(out, reference),
            calls,
            70.0,
        ),
    ]


_C_MAIN = """#include "friction.h"
#include <stdio.h>
#include <time.h>
int main(void)
{
    joint_state_t state;
    joint_input_t input = {0.03, 0.029, 0.002, 1.2, true, true, true};
    volatile double sum = 0.0;
    struct timespec a;
    struct timespec b;
    joint_reset(&state);
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &a);
    for (long i = 0; i < 2000000L; i++) {
        input.velocity_reference = 0.03 + (1e-9 * (double)i);
        sum = sum + joint_torque(&state, &input);
    }
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &b);
    printf("%.9g\\n", ((double)(b.tv_sec - a.tv_sec) + (1e-9 * (double)(b.tv_nsec - a.tv_nsec))) / 2e6);
    return 0;
}
"""


def measure_c() -> Cost | None:
    """Time the generated C in a C loop; None without gcc."""
    if shutil.which("gcc") is None:
        return None
    settings = full_compensator().settings
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "friction.h").write_text(render_c_header(bench_model(), settings, prefix="joint"))
        (folder / "main.c").write_text(_C_MAIN)
        flags = ["-std=gnu99", "-Wall", "-Wextra", "-Werror", "-O2"]
        subprocess.run(["gcc", *flags, "main.c", "-o", "main", "-lm"], cwd=folder, check=True, capture_output=True)
        took, ratios = [], []
        for _ in range(5):
            base, _ = time_beside_unit(call_unit, 2_000)
            took.append(float(subprocess.run(["./main"], cwd=folder, check=True, capture_output=True).stdout))
            ratios.append(took[-1] / base)
    return Cost("generated C, every feature, in a C loop", float(np.median(took)), float(np.median(ratios)), 0.6)


def measure_growth(ticks: int) -> int:
    """Memory blocks that `ticks` of compensation and gate leave behind; a constant few is none."""
    tick = _seven_with_gate()
    for _ in range(1000):
        tick()
    before = sys.getallocatedblocks()
    for _ in range(ticks):
        tick()
    return sys.getallocatedblocks() - before


def measure_import_ratio() -> float:
    """Processor time of `import fricomp` over that of `import numpy`, each the shortest of several processes [1]."""

    def shortest(module: str) -> float:
        code = f"import time; start = time.process_time(); import {module}; print(time.process_time() - start)"
        runs = [subprocess.run([sys.executable, "-c", code], check=True, capture_output=True) for _ in range(7)]
        return min(float(run.stdout) for run in runs)

    return shortest("fricomp") / shortest("numpy")
