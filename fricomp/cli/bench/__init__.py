"""Benchmarks, one a module: `fricomp bench <name> [--quick] --out DIR`."""

from __future__ import annotations

from fricomp.cli.lazy import lazy_app

__all__ = ["BENCHMARKS", "app"]

BENCHMARKS = {
    "stand-in": "How truly the simulated joint sticks and slides, and how fast.",
    "calibrate": "Ten seeds of the whole calibration on the default stand-in joint.",
    "motion": "Whether intervals from recorded motions hold the truth.",
    "paper": "The paper's tables, with the methods beside it, over many seeds.",
    "latency": "Cost of the compensator and lateness of the loop.",
    "tracking": "Tracking with and without compensation.",
    "adapters": "Every adapter against its twin and an independent peer.",
    "fleet": "Joints a second, identified in one call and one by one.",
    "mismatch": "Named physics in concealed cases.",
    "mismatch-gap": "How much of the held-out error a diagnosis closes.",
    "mismatch-speed-up": "How much faster two workers diagnose than one.",
    "mismatch-replay": "A scored run made again, or its seals checked.",
    "mismatch-close": "End a scored run before its last case.",
    "second-generator": "Named physics in joints that MuJoCo makes.",
    "real": "Diagnosis on public recordings of real joints.",
}
"""Benchmark to the line that `fricomp bench --help` shows; each lives in `fricomp/cli/bench/<name>.py`."""

app = lazy_app(
    "fricomp.cli.bench",
    BENCHMARKS,
    help="Benchmarks: every figure of the documentation, measured again.",
    add_completion=False,
)
