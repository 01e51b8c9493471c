"""One joint calibrated through every adapter and its twin, beside the same joint calibrated without a drive."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.adapters import open_adapter
from fricomp.calibration.sweep import (
    Calibration,
    CalibrationOptions,
    CalibrationRequest,
    IdentificationSettings,
    RunFolder,
    SweepContext,
    SweepSettings,
    calibrate,
)

__all__ = [
    "AGREES",
    "WITHIN",
    "CalibrationComparison",
    "ParameterComparison",
    "calibrate_backend",
    "chance_explains",
    "compare_all",
]

AGREES = 0.01
"""Without noise a parameter agrees within this beyond the stated quantisation [1]."""
WITHIN = 2.0
"""With noise within so many combined standard errors; of many comparisons one in twenty misses that by chance."""
SHARE_WITHIN = 0.9
FAR = 4.0

QUICK = SweepSettings(speeds="0.009,0.024,0.072,0.09,0.12,0.4,1.5,4.0", repeats=1, warm_up=2.0, breakaway_positions=0)


@dataclass(frozen=True)
class ParameterComparison:
    """One parameter.

    Attributes:
        name: Which.
        alone: Value without a drive.
        through: Value through the drive.
        deviation: Combined standard error of their difference.
        quantisation: Half a step of the drive's torque, as a fraction of the parameter; 0 where it is no torque [1].
    """

    name: str
    alone: float
    through: float
    deviation: float
    quantisation: float

    @property
    def error(self) -> float:
        """Relative difference [1]."""
        return self.through / self.alone - 1.0

    @property
    def normalised(self) -> float:
        """Difference in combined standard errors."""
        return (self.through - self.alone) / self.deviation


@dataclass(frozen=True)
class CalibrationComparison:
    """One protocol.

    Attributes:
        protocol: Which.
        noise: Whether the joint's sensors are noisy.
        mode: Command mode of the sweep.
        n_used: Plateaus that slid steadily.
        n_planned: Of so many.
        parameters: All of the law.
    """

    protocol: str
    noise: bool
    mode: str
    n_used: int
    n_planned: int
    parameters: tuple[ParameterComparison, ...]

    @property
    def worst(self) -> ParameterComparison:
        """The parameter that is farthest off."""
        return max(self.parameters, key=lambda p: abs(p.normalised) if self.noise else abs(p.error) - p.quantisation)

    @property
    def n_within(self) -> int:
        """Parameters within two combined standard errors."""
        return sum(abs(p.normalised) <= WITHIN for p in self.parameters)

    @property
    def passed(self) -> bool:
        """Without noise whether all agree; with noise whether none is off by more than chance."""
        if self.noise:
            return abs(self.worst.normalised) <= FAR
        return all(abs(p.error) <= AGREES + p.quantisation for p in self.parameters)


def compare_all(noise: bool, protocols: Sequence[str], *, quick: bool) -> tuple[CalibrationComparison, ...]:
    """Calibrate the default joint alone and through each protocol.

    Args:
        noise: Whether its sensors are noisy, and have an offset.
        protocols: Of `PROTOCOLS`.
        quick: Few speeds, once each.
    """
    settings = QUICK if quick else SweepSettings()
    alone, _ = calibrate_backend("sim", noise, settings)
    found = []
    for number, protocol in enumerate(protocols, start=1):
        through, mode = calibrate_backend(f"twin-{protocol}", noise, settings, seed=number)
        found.append(_compare(protocol, noise, mode, alone, through))
    return tuple(found)


def calibrate_backend(backend: str, noise: bool, settings: SweepSettings, seed: int = 0) -> tuple[Calibration, str]:
    """A calibration of the default joint, and the command mode it used.

    Args:
        backend: `sim`, or that of a twin.
        noise: Whether the sensors are noisy.
        settings: Of the sweep.
        seed: Of the noise.
    """
    quiet = {} if noise else {"sensor": {"torque_noise": 0.0, "torque_offset": 0.0}}
    sim: dict[str, Any] = {"seed": seed, "joints": [{"name": "joint", **quiet}]}
    configuration = sim if backend == "sim" else {"sim": sim}
    options = CalibrationOptions(IdentificationSettings(method="least_squares"))
    request = CalibrationRequest(backend, configuration, settings=settings, options=options)
    with tempfile.TemporaryDirectory() as folder, open_adapter(backend, configuration) as adapter:
        context = SweepContext(adapter, 0, settings)
        return calibrate(context, RunFolder.create(Path(folder), request), options), context.choose_mode()


def _compare(protocol: str, noise: bool, mode: str, alone: Calibration, through: Calibration) -> CalibrationComparison:
    a, b = alone.estimate.result, through.estimate.result
    step = float(through.analysis.metadata.extra["torque_quantum"])
    rows = []
    for name in a.parameter_names:
        deviation = float(np.hypot(a.standard_deviations[name], b.standard_deviations[name]))
        half = 0.5 * step / a.parameters[name] if name.endswith("_torque") else 0.0
        rows.append(ParameterComparison(name, a.parameters[name], b.parameters[name], deviation, half))
    points = through.analysis
    return CalibrationComparison(protocol, noise, mode, len(points.steady), len(points.points), tuple(rows))


def chance_explains(comparisons: Sequence[CalibrationComparison]) -> bool:
    """Whether at least nine in ten parameters of all noisy comparisons are within two combined standard errors."""
    noisy = [c for c in comparisons if c.noise]
    total = sum(len(c.parameters) for c in noisy)
    return total == 0 or sum(c.n_within for c in noisy) >= SHARE_WITHIN * total
