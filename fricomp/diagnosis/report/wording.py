"""Numbers and intervals as people read them: with the digits that mean something, and their units."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10, pi
from pathlib import Path

from fricomp.overview import AT_BOUND

from ..record.result import Diagnosis, DiagnosisRecord, Location, NamedEffect, Quantity
from ..record.sentence import describe_parameter
from .settings import REPORT

VERDICT_TITLES = {
    "consistent": "nothing is missing",
    "parameters": "parameters are off, no physics is missing",
    "measurement": "the measurement is off, not the joint",
    "missing_physics": "physics is missing",
    "unknown_physics": "something outside the catalogue is there",
    "bad_data": "the data cannot be used",
}

AXIS_TITLES = {
    "time": "time",
    "velocity": "velocity",
    "position": "position",
    "acceleration": "acceleration",
    "load_torque": "load",
    "time_since_reversal": "time since the last reversal",
    "temperature": "temperature",
}


@dataclass(frozen=True)
class Units:
    """Units of one diagnosis.

    Attributes:
        torque: Of the residual, such as "N·m" or "A".
        position: "rad" or "m".
    """

    torque: str = "N·m"
    position: str = "rad"

    @classmethod
    def read(cls, diagnosis: Diagnosis) -> Units:
        """The units that the models and the held-out error of a diagnosis state."""
        model = diagnosis.base_model or diagnosis.extended_model
        if model is not None:
            return cls(model.torque_unit, model.position_unit)
        return cls(diagnosis.heldout.unit) if diagnosis.heldout is not None else cls()

    def find_unit(self, quantity: str) -> str:
        """Unit of a quantity that residuals are located by."""
        x = self.position
        known = {"velocity": f"{x}/s", "position": x, "acceleration": f"{x}/s²", "load_torque": self.torque}
        known |= {"frequency": "Hz", "temperature": "°C"}
        return known.get(quantity, "s")

    def label_axis(self, quantity: str) -> str:
        """Axis label with the unit."""
        return f"{AXIS_TITLES.get(quantity, describe_name(quantity))} [{self.find_unit(quantity)}]"


def describe_name(name: str) -> str:
    """A name in a file as words: `forward.coulomb_torque` is `coulomb torque, forward`."""
    parts = [describe_parameter(part) for part in name.split(".")]
    return ", ".join(reversed(parts))


def format_number(value: float, step: float | None = None) -> str:
    """`value` with the digits that `step` leaves meaningful; four significant ones without it."""
    if not isfinite(value):
        return "–"
    step = step if step and isfinite(step) else None
    size = max(abs(value), step or 0.0)
    if size and not 1e-3 <= size < 1e6:
        figures = 3 if not step else min(9, max(0, ceil(log10(size / step)) + 1)) if value else 1
        return f"{value:.{figures}g}" if figures else "0"
    if not step:
        return f"{value:.4g}"
    return f"{value:.{min(9, max(0, 1 - floor(log10(step))))}f}"


def format_interval(quantity: Quantity) -> str:
    """The 95 % interval, without its unit; none of a number that was chosen among a few, such as a filter's order."""
    low, high = quantity.ci95
    bound = f", {AT_BOUND}" if quantity.at_bound else ""
    if low == high:
        return AT_BOUND if quantity.at_bound else "–"
    if not (isfinite(low) and isfinite(high)):
        return f"not determined{bound}"
    step = 0.5 * (high - low) or None
    return f"{format_number(low, step)} to {format_number(high, step)}{bound}"


def format_quantity(quantity: Quantity, *, determined: bool = True) -> str:
    """Value, half of its 95 % interval, and its unit; less where it is not determined, or spans orders of magnitude."""
    half = 0.5 * (quantity.ci95[1] - quantity.ci95[0])
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    bound = f", {AT_BOUND}" if quantity.at_bound else ""
    if not determined:
        return f"not determined (about {format_number(quantity.value)}{unit}, {format_interval(quantity)})"
    if not isfinite(half) or half <= 0.0:
        return f"{format_number(quantity.value)}{unit}{bound}"
    if quantity.ci95[0] >= 0.0 and quantity.ci95[1] > REPORT.undetermined * quantity.value:
        return f"not determined (about {format_number(quantity.value)}{unit}{bound})"
    return f"{format_number(quantity.value, half)} ± {format_number(half, half)}{unit}{bound}"


def format_location(location: Location, units: Units) -> str:
    """Intervals by quantity in one line, such as `load 2 to 5.5 N·m; velocity -0.1 to 0.1 rad/s`."""
    parts = []
    for quantity, intervals in location.items():
        spans = ", ".join(f"{low:.3g} to {high:.3g}" for low, high in intervals[: REPORT.intervals])
        more = f" and {len(intervals) - REPORT.intervals} more" if len(intervals) > REPORT.intervals else ""
        parts.append(f"{AXIS_TITLES.get(quantity, describe_name(quantity))} {spans} {units.find_unit(quantity)}{more}")
    return "; ".join(parts)


def describe_next_step(record: DiagnosisRecord, folder: Path | None = None) -> str | None:
    """What to record next, in one sentence with its command; None where no motion is proposed.

    Args:
        record: Of the diagnosis.
        folder: Where its files are.
    """
    proposed = record.next_experiment
    if proposed is None:
        return None
    *others, last = proposed.separates
    names = f"{', '.join(others)} and {last}" if others else last
    motion = shlex.quote(str((folder or Path()) / proposed.motion))
    return (
        f"What this recording cannot tell apart: {names}. To tell, record {proposed.why.rstrip('.')}: "
        f"fricomp calibrate --backend … --motion {motion} --out runs/next; then diagnose this recording together with "
        "runs/next/motion-alone.csv."
    )


def derive_parameters(effect: NamedEffect) -> Mapping[str, Quantity]:
    """Parameters of an effect, and what people look up instead: a ripple's period, its amplitude in each recording."""
    found = dict(effect.parameters)
    order = found.get("order")
    # The order of a filter, or of an encoder's wave in a turn, is no order over position.
    if order is not None and order.unit in ("1/rad", "1/m") and "period" not in found and order.value > 0.0:
        low, high = order.ci95
        unit = order.unit.removeprefix("1/")
        interval = (2.0 * pi / high, 2.0 * pi / low) if low > 0.0 else (float("nan"), float("nan"))
        found["period"] = Quantity(2.0 * pi / order.value, unit, interval)
    for name, sine in effect.parameters.items():
        of_wave = name.removeprefix("sine")  # "_2" of the second recording, whose encoder starts anew
        cosine = found.get(f"cosine{of_wave}")
        if name.startswith("sine") and cosine is not None:
            found.setdefault(f"amplitude{of_wave}", _compute_amplitude(sine, cosine))
    return found


def _compute_amplitude(sine: Quantity, cosine: Quantity) -> Quantity:
    """Length of a ripple's two parts, with the interval carried over to first order."""
    size = (sine.value**2 + cosine.value**2) ** 0.5
    halves = [0.5 * (part.ci95[1] - part.ci95[0]) for part in (sine, cosine)]
    spread = ((sine.value * halves[0]) ** 2 + (cosine.value * halves[1]) ** 2) ** 0.5 / max(size, 1e-300)
    return Quantity(size, sine.unit, (max(size - spread, 0.0), size + spread))
