"""Benchmarks, one a module: `fricomp bench <name> [--quick] --out DIR`."""

from fricomp.cli.lazy import lazy_app

__all__ = ["BENCHMARKS", "app"]

BENCHMARKS = {
    "stand-in": "How truly the simulated joint sticks and slides, and how fast.",
    "calibrate": "Ten seeds of the whole calibration on the default stand-in joint.",
    "motion": "Whether intervals from recorded motions hold the truth.",
    "logs": "What comes of logs with flaws, one or two at a time.",
    "paper": "The paper's tables, with the methods beside it, over many seeds.",
    "latency": "Cost of the compensator and lateness of the loop.",
    "speed": "How long everything takes, how that grows, and other packages beside it.",
    "tracking": "Tracking with and without compensation.",
    "adapters": "Every adapter against its twin and an independent peer.",
    "fleet": "Joints a second, identified in one call and one by one.",
    "mismatch": "Named physics in concealed cases: run, page, gap, replay, compare, speed-up.",
    "arms": "Named physics and links of concealed arms: run, page.",
    "second-generator": "Named physics in joints that MuJoCo makes.",
    "real": "Diagnosis on public recordings of real joints.",
}
"""Benchmark to the line that `fricomp bench --help` shows; each is a module or package `fricomp/cli/bench/<name>`."""

app = lazy_app(
    "fricomp.cli.bench",
    BENCHMARKS,
    help="Benchmarks: every figure of the documentation, measured again.",
    add_completion=False,
)
