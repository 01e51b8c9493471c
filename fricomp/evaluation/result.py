"""What an evaluation says: errors of torque and of motion, in the units of the recording."""

from dataclasses import asdict, dataclass
from typing import Any

from fricomp.overview import Overview, OverviewTable, Shown

EVALUATION_SCHEMA = "fricomp.evaluation/1"

Interval = tuple[float, float]


@dataclass(frozen=True)
class TorqueError:
    """Recorded torque less that of the model along the recorded motion, where the joint moves.

    Attributes:
        rms: Root mean square [`unit`].
        ci95_rms: Its 95 % interval over blocks of time.
        median: Median of its size.
        recorded: Root mean square of the recorded torque about its mean, over the same samples: what no model leaves.
        unit: `N·m`, `N` or `A`, as recorded.
        band: Both torques pass the same low-pass up to here [Hz].
        duration: Time in motion [s].
    """

    rms: float
    ci95_rms: Interval
    median: float
    recorded: float
    unit: str
    band: float
    duration: float


@dataclass(frozen=True)
class PositionError:
    """Position of an open-loop simulation, driven by the recorded torque from measured states, less the recorded one.

    Attributes:
        after: Time from the start [s].
        median: Median of its size over the starts [`unit`].
        ci95_median: Its 95 % interval over blocks of starts.
        rms: Root mean square over the starts.
        travel: Median of the way that the joint itself went: what a model that stands still is off by.
        starts: Number of starts.
        unit: `rad` or `m`.
    """

    after: float
    median: float
    ci95_median: Interval
    rms: float
    travel: float
    starts: int
    unit: str


@dataclass(frozen=True, repr=False)
class Evaluation(Shown):
    """How well a model predicts a recording.

    Attributes:
        model: What was evaluated, in words.
        torque: Error along the recorded motion.
        position: Errors of open-loop simulations, by their length; a recording may be too short for the longer ones.
        notes: What to know about the figures, in sentences.
    """

    model: str
    torque: TorqueError
    position: tuple[PositionError, ...]
    notes: tuple[str, ...] = ()

    def after(self, time: float) -> PositionError | None:
        """The position error after that time [s]; None where there is none."""
        return next((one for one in self.position if one.after == time), None)

    def to_json(self) -> dict[str, Any]:
        """All figures as JSON values; `docs/evaluation.md` describes them."""
        return {"schema": EVALUATION_SCHEMA, **asdict(self)}

    def headline(self) -> str:
        """Torque error, and the first position error."""
        first = "".join(f", {one.median:.3g} {one.unit} after {one.after:g} s" for one in self.position[:1])
        return f"of {self.model}: {self.torque.rms:.3g} {self.torque.unit}{first}"

    def overview(self) -> Overview:
        """Both tables."""
        torque = self.torque
        low, high = torque.ci95_rms
        row = (f"{torque.rms:.4g}", f"{low:.4g} to {high:.4g}", f"{torque.median:.4g}", f"{torque.recorded:.4g}")
        heads = ("RMS", "95 % interval", "median", "RMS of the recorded torque")
        rows = tuple(
            (
                f"{one.after:g} s",
                f"{one.median:.4g}",
                f"{one.ci95_median[0]:.4g} to {one.ci95_median[1]:.4g}",
                f"{one.rms:.4g}",
                f"{one.travel:.4g}",
                str(one.starts),
            )
            for one in self.position
        )
        unit = self.position[0].unit if self.position else ""
        return Overview(
            f"Evaluation of {self.model}",
            (
                f"Torque error in the band from 0 to {torque.band:g} Hz, over {torque.duration:.4g} s in motion.",
                *self.notes,
            ),
            (
                OverviewTable(("error", *heads), ((f"torque [{torque.unit}]", *row),)),
                OverviewTable(
                    (f"position error [{unit}] after", "median", "95 % interval", "RMS", "the joint moved", "starts"),
                    rows,
                ),
            ),
        )
