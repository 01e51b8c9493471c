"""What a diagnosis says: the record that `diagnosis.json` holds, and the curves behind it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import msgspec

from fricomp.evaluation import RecordedMotion
from fricomp.model import FrictionModel
from fricomp.recording.parts.parts import UsableParts

from ..inputs.track import FloatArray
from .file_errors import FileErrors
from .overview import DiagnosisOverview

__all__ = [
    "DIAGNOSIS_SCHEMA",
    "FRICTION_CHANGES",
    "Change",
    "Diagnosis",
    "DiagnosisRecord",
    "Distinguishability",
    "Evidence",
    "FileSeries",
    "Forward",
    "HeldOut",
    "NamedEffect",
    "NextExperiment",
    "Quantity",
    "Rival",
    "RowSeries",
    "VerdictName",
]

DIAGNOSIS_SCHEMA = "fricomp.diagnosis/1"

FRICTION_CHANGES = ("frictionloss", "damping")
"""Changes of a simulation's own friction, by the names that MJCF has for it."""

VerdictName = Literal["consistent", "parameters", "measurement", "missing_physics", "unknown_physics", "bad_data"]
Kind = Literal["physics", "measurement", "parameter"]
Interval = tuple[float, float]
Location = dict[str, list[Interval]]


class Quantity(msgspec.Struct, frozen=True):
    """A number with its unit and its 95 % interval.

    Attributes:
        value: The number.
        unit: Its unit; "1" for none.
        ci95: Ends of the interval.
        at_bound: Whether it stands where its domain or the search for it ends, and the data ask for more than that.
    """

    value: float
    unit: str
    ci95: Interval
    at_bound: bool = False


class NamedEffect(msgspec.Struct, frozen=True, kw_only=True):
    """An effect that was named.

    Attributes:
        name: Name in the catalogue.
        kind: "physics", "measurement" or "parameter".
        parameters: Its numbers.
        indistinguishable_from: Effects that explain this recording as well.
        location: Where it acts, as intervals by quantity.
        share: Part of the residual energy above the noise floor that it explains on held-out data.
        equation: Its equation.
        sentence: What it means, in words.
        citation: Key in the list of references; empty where no source is needed.
    """

    name: str
    kind: Kind
    parameters: dict[str, Quantity]
    indistinguishable_from: tuple[str, ...] = ()
    location: Location = {}
    share: float = 0.0
    equation: str = ""
    sentence: str = ""
    citation: str = ""


class HeldOut(msgspec.Struct, frozen=True, kw_only=True):
    """Root mean square errors on blocks that the fit did not use, over the rows of the residual.

    Each row counts by its own noise, and the errors are in that of a typical row: what a model leaves about reversals,
    where no bristle is quite right, does not drown the rest.

    Attributes:
        rmse_before: Of the base model.
        rmse_after: Of the model with the named effects.
        noise_floor: What a model with nothing missing would leave.
        unit: Unit of the three.
        before: What the first of them belongs to: the base model refitted, or with parameters as they were given,
            where only parameters are off; then the second is that of the base model refitted.
        ci95_reduction: 95 % interval of 1 - rmse_after / rmse_before, by block bootstrap.
        explained: Part of the energy above the noise floor that the named effects remove.
    """

    rmse_before: float
    rmse_after: float
    noise_floor: float
    unit: str
    ci95_reduction: Interval
    explained: float
    before: Literal["refitted", "given"] = "refitted"

    @property
    def rmse_refitted(self) -> float:
        """Of the base model refitted, whatever the first error belongs to."""
        return self.rmse_after if self.before == "given" else self.rmse_before


class Forward(msgspec.Struct, frozen=True, kw_only=True):
    """Position errors of a forward simulation in MuJoCo under the recorded reference, on time that the fit did not use.

    Attributes:
        rmse_before: Of the base model.
        rmse_after: Of the model with the named effects.
        unit: Unit of both.
        controller: The loop that moved the joint, and where it comes from.
        interval: The time that was simulated [s], of the first recording.
    """

    rmse_before: float
    rmse_after: float
    unit: str
    controller: str
    interval: Interval


class NextExperiment(msgspec.Struct, frozen=True, kw_only=True):
    """A motion that would tell apart what this recording cannot."""

    motion: str
    separates: tuple[str, ...]
    why: str


class Rival(msgspec.Struct, frozen=True, kw_only=True):
    """One explanation that was weighed.

    Attributes:
        effects: Names of its effects.
        gain: Fall of the weighted squared residual after the joint refit, less the BIC penalty.
        coverage: Part of the explainable energy it covers; NaN is written as null where it was not computed.
        refused: Why it was not accepted; empty for the accepted one.
    """

    effects: tuple[str, ...]
    gain: float
    coverage: float | None = None
    refused: str = ""


class Distinguishability(msgspec.Struct, frozen=True):
    """One minus R² of the effect of a row by the effect of a column, after the base model is refitted."""

    names: tuple[str, ...]
    matrix: list[list[float]]


class Change(msgspec.Struct, frozen=True, kw_only=True):
    """A parameter of the given simulation that a refit moves."""

    name: str
    given: float
    refitted: Quantity


class DiagnosisRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The content of `diagnosis.json`.

    Attributes:
        schema: "fricomp.diagnosis/1".
        verdict: The answer in one word.
        effects: What was named, of any kind, strongest first.
        summary: The answer in a few sentences: what is wrong, where, what it is, what to do.
        sentences: The whole answer in plain words, most important first.
        errors: Of the models that are written, in the units of the recording, on held-out data; None where none is.
        heldout: Whitened errors of the rows that decide, before and after; None where nothing could be simulated.
        forward: Errors of a forward simulation; None where no loop is known or no reference was recorded.
        location: Where the mismatch of the base model sits, as intervals by quantity.
        next_experiment: What to record next, where something could not be told apart.
        noise_ratio: Residual of the base model over its noise floor.
        coverage: Part of the explainable energy that the named effects cover; None where nothing stood out.
        base: Parameters of the refitted base model.
        undetermined: Names of numbers of the base, and of effects as `effect.number`, that these recordings do not
            determine: half of the interval is more than the number, and what it may be makes a difference.
        changes: Parameters of the given simulation that the refit moved.
        rivals: Explanations that were weighed, best first.
        probability: Of each name that came up, of "nothing" and of "unknown": how often the answer comes again on parts
            of the rows, as far as that has been right on joints whose answer is known. Names below the bar are not
            among the effects.
        distinguishability: Which effects this recording could tell apart.
        recordings: Names of the recordings.
        joint: Name of the joint.
    """

    schema: str
    verdict: VerdictName
    effects: tuple[NamedEffect, ...] = ()
    summary: tuple[str, ...] = ()
    sentences: tuple[str, ...] = ()
    errors: FileErrors | None = None
    heldout: HeldOut | None = None
    forward: Forward | None = None
    location: Location = {}
    next_experiment: NextExperiment | None = None
    noise_ratio: float | None = None
    coverage: float | None = None
    base: dict[str, Quantity] = {}
    undetermined: tuple[str, ...] = ()
    changes: tuple[Change, ...] = ()
    rivals: tuple[Rival, ...] = ()
    probability: dict[str, float] = {}
    distinguishability: Distinguishability | None = None
    recordings: tuple[str, ...] = ()
    joint: str = ""


@dataclass(frozen=True)
class RowSeries:
    """One recording's residual rows and where the joint was. Arrays of shape (n_rows,).

    Attributes:
        name: Name of the recording.
        time: [s].
        position: [rad] or [m].
        velocity: [rad/s] or [m/s].
        acceleration: [rad/s²] or [m/s²].
        load_torque: [N·m] or [N].
        time_since_reversal: [s].
        temperature: [°C]; None where it was not recorded.
        before: Missing torque of the base model.
        after: Missing torque of the model with the named effects.
        spread: Standard deviation of a row where nothing is missing.
    """

    name: str
    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    load_torque: FloatArray
    time_since_reversal: FloatArray
    temperature: FloatArray | None
    before: FloatArray
    after: FloatArray
    spread: FloatArray


@dataclass(frozen=True)
class FileSeries:
    """Torque that the written models leave, over a part of a recording. Arrays of shape (n,).

    Attributes:
        name: Name of the recording.
        time: [s].
        before: Of the base model; NaN where the joint rests.
        after: Of the model that is written.
        band: It is shown up to here [Hz].
    """

    name: str
    time: FloatArray
    before: FloatArray
    after: FloatArray
    band: float


@dataclass(frozen=True)
class Evidence:
    """The curves behind a diagnosis, for plots.

    Attributes:
        series: Residual rows of each recording.
        maps: Excess energy over bins of each quantity, in units of the noise: edges, excess, and its 95 % band.
        orders: Order over position and the energy each explains, before and after.
        change_points: Times at which the size of the residual changes [s], for each recording.
        files: Torque that the written models leave.
    """

    series: tuple[RowSeries, ...] = ()
    maps: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    orders: dict[str, FloatArray] = field(default_factory=dict)
    change_points: tuple[tuple[float, ...], ...] = ()
    files: tuple[FileSeries, ...] = ()


@dataclass(frozen=True, repr=False)
class Diagnosis(DiagnosisOverview):
    """The answer of `diagnose`.

    Attributes:
        record: What `diagnosis.json` holds.
        evidence: Curves for plots; empty for a diagnosis that was read from a file.
        base_model: Friction of the refitted base; None where the data were bad.
        extended_model: The same with the named effects, refitted together; None where nothing can be added.
        motion: Columns of the motion that would tell the aliases apart; None where none is needed.
        detent_order: Order over the position of torque and friction that one unknown part ripples [1/rad] or [1/m];
            None where none was seen.
        folds: Models that the held-out errors are of: base, and extended where there is one, one a fold.
        fold_times: Times of each fold [s].
        recorded: The recordings as errors were measured on them; None where none were, or read from a file.
        covariance: Of the refitted base, shape (p, p), in the order and coordinates of `BASE_NAMES`; None where
            the verdict is not about such a fit.
        data: What was used of each recording and what was not; empty for a diagnosis that was read from a file.
    """

    record: DiagnosisRecord
    evidence: Evidence = field(default_factory=Evidence)
    base_model: FrictionModel | None = None
    extended_model: FrictionModel | None = None
    motion: dict[str, FloatArray] | None = None
    detent_order: float | None = None
    covariance: FloatArray | None = None
    folds: tuple[tuple[FrictionModel, ...], ...] = ()
    fold_times: tuple[tuple[Interval, ...], ...] = ()
    data: tuple[UsableParts, ...] = ()
    recorded: RecordedMotion | None = None

    @property
    def verdict(self) -> VerdictName:
        """The answer in one word."""
        return self.record.verdict

    @property
    def effects(self) -> tuple[NamedEffect, ...]:
        """What was named, strongest first."""
        return self.record.effects

    @property
    def sentences(self) -> tuple[str, ...]:
        """The answer in plain words."""
        return self.record.sentences

    @property
    def heldout(self) -> HeldOut | None:
        """Errors on held-out blocks."""
        return self.record.heldout
