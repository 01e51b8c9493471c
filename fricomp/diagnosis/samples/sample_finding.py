"""What the samples of a recording show and the rows of the residual cannot: a candidate beside the search's answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fricomp.laws import COGGING_TERMS, POSITION_COULOMB_TERMS, FrictionLaw, Term
from fricomp.model import FrictionModel
from fricomp.root_mean_square import compute_rms

from ..effects import EFFECTS
from ..evidence.findings import Findings
from ..inputs.track import FloatArray
from ..record.result import HeldOut, Kind, Quantity, Rival, RowSeries
from ..search.generic import measure_time_since_reversal
from .drive_path import DrivePath
from .fine_ripple import FineRipple, Harmonic
from .settings import LOOK
from .soft_presliding import SoftPresliding

_STEP = 0.6745 * float(np.sqrt(2.0))
"""Median size of the difference of two numbers from one normal distribution, over its standard deviation."""


@dataclass(frozen=True)
class SampleFinding:
    """An effect that the samples show, with what speaks for it.

    Attributes:
        name: Of the effect in the catalogue.
        kind: "physics" or "measurement".
        parameters: Its numbers with their intervals.
        equation: Its equation.
        sentence: What it means, in words.
        held: Errors of samples on blocks that were left out; it explains `held.explained` of them.
        series: Residual of the samples, before and after.
        alike: Effects that explain the samples as well.
        lawless: Whether the joint obeys no law of its own motion, so that nothing but its drive can be judged.
        rivals: Explanations of the samples that were weighed, best first; empty where only this one was.
        orders: Energy that a ripple of each order explains; empty where none was looked for.
        ripple: Order [1/rad] and amplitude [N·m] of a ripple; None for other effects.
        law: Friction law that takes the place of the base's; None where the base's stays.
        terms: Terms of a friction law beside the base's.
        waves: Of a ripple, in each recording; empty for other effects.
    """

    name: str
    kind: Kind
    parameters: dict[str, Quantity]
    equation: str
    sentence: str
    held: HeldOut
    series: tuple[RowSeries, ...]
    alike: tuple[str, ...] = ()
    lawless: bool = False
    rivals: tuple[Rival, ...] = ()
    orders: dict[str, FloatArray] = field(default_factory=dict)
    ripple: tuple[float, float] | None = None
    law: FrictionLaw | None = None
    terms: tuple[Term, ...] = ()
    waves: tuple[tuple[Harmonic, ...], ...] = ()

    def extend(self, model: FrictionModel) -> FrictionModel | None:
        """The base refitted, or that with effects of the rows, with this effect too; None where it belongs to no
        friction law. Orders for which a law has no term left are left out."""
        if self.law is not None:
            return model.with_law(self.law)
        law = model.law
        for term in self.terms:
            used = {one.name for one in law.terms}
            free = [kind for kind in _find_family(term) if kind.name not in used]
            law = law.with_term(free[0](**term.parameters())) if free else law
        return model.with_law(law) if self.terms else None

    @property
    def share(self) -> float:
        """Part of the repetitions, each without a fifth of the blocks, in which most of the error that goes on all of
        them goes as well."""
        energy = [self._sum_blocks(side) for side in ("before", "after")]
        rng, kept = np.random.default_rng(0), round(0.8 * LOOK.blocks)
        drawn = [rng.choice(LOOK.blocks, kept, replace=False) for _ in range(LOOK.repetitions)]
        falls = np.array([1.0 - energy[1][one].sum() / max(float(energy[0][one].sum()), 1e-300) for one in drawn])
        return float(np.mean(falls > 0.5 * (1.0 - energy[1].sum() / max(float(energy[0].sum()), 1e-300))))

    def _sum_blocks(self, side: str) -> FloatArray:
        """Energy of the samples' residual in each block. Shape (n_blocks,)."""
        parts = np.array_split(np.concatenate([getattr(one, side) for one in self.series]), LOOK.blocks)
        return np.array([float(part @ part) for part in parts])

    @property
    def citation(self) -> str:
        """Key in the list of references."""
        return EFFECTS[self.name].citation


def _find_family(term: Term) -> tuple[type[Term], ...]:
    """The terms that draw the same kind of wave."""
    family: tuple[type[Term], ...] = COGGING_TERMS if isinstance(term, COGGING_TERMS) else POSITION_COULOMB_TERMS
    return family


def describe_ripple(findings: Findings, ripples: Sequence[FineRipple]) -> SampleFinding:
    """A ripple that is finer than the rows."""
    unit = findings.case.unit
    strongest = ripples[0].harmonics[0]
    name = "position_coulomb" if strongest.level else "cogging"
    others = ", ".join(
        f"{h.order:.5g} ({h.amplitude:.3g} {unit})" for h in ripples[0].harmonics[1 : 1 + LOOK.further_orders]
    )
    more = f"; further orders {others}" if others else ""
    return SampleFinding(
        name=name,
        kind="physics",
        parameters=_list_parameters(strongest, unit, findings.case.position_unit),
        equation="tau = sum of A_k sin(n_k q + phi_k)" + (", times sgn(v)" if strongest.level else ""),
        sentence=f"{EFFECTS[name].says}, finer than the rows of the residual{more}",
        held=_hold_out(findings, ripples),
        series=_collect_series(findings, ripples),
        orders=ripples[0].orders,
        ripple=(strongest.order, strongest.amplitude),
        terms=_list_waves(ripples[0].harmonics),
        waves=tuple(one.harmonics for one in ripples),
    )


def _list_waves(harmonics: Sequence[Harmonic]) -> tuple[Term, ...]:
    """The strongest orders of the torque and of the level of friction, as many as a law has terms for."""
    terms: list[Term] = []
    for kinds, level in ((COGGING_TERMS, False), (POSITION_COULOMB_TERMS, True)):
        waves = [one for one in harmonics if one.level == level]
        terms += [kind(wave.sine, wave.cosine, wave.order) for kind, wave in zip(kinds, waves, strict=False)]
    return tuple(terms)


def describe_presliding(findings: Findings, soft: Sequence[SoftPresliding]) -> SampleFinding:
    """Presliding that fills the motion."""
    unit, position = findings.case.unit, findings.case.position_unit
    first, known = soft[0], EFFECTS["presliding_hysteresis"]
    wide, half = float(np.exp(1.96 * first.distance_error)), 1.96 * first.level_error
    stiffness = first.level / first.distance
    return SampleFinding(
        name=known.name,
        kind="physics",
        parameters={
            "breakaway_distance": Quantity(first.distance, position, (first.distance / wide, first.distance * wide)),
            "coulomb_torque": Quantity(first.level, unit, (first.level - half, first.level + half)),
            "sigma_0": Quantity(stiffness, f"{unit}/{position}", (stiffness / wide, stiffness * wide)),
        },
        equation=known.equation,
        sentence=f"{known.says}, which fills much of this motion; nothing without memory explains it",
        held=_hold_out(findings, soft),
        series=_collect_series(findings, soft),
        law=first.law,
    )


def describe_drive_path(findings: Findings, path: DrivePath) -> SampleFinding:
    """A drive that follows its command late."""
    unit = findings.case.unit
    other = {"drive_lag": "torque_delay", "torque_delay": "drive_lag"}[path.name]
    half = 1.96 * path.deviation
    parameter = "delay" if path.name == "torque_delay" else "time_constant"
    recording = findings.case.recordings[0]
    t = np.asarray(recording.time) - recording.time[0]
    position = np.asarray(recording.position)
    velocity = np.gradient(position, t) if recording.velocity is None else np.asarray(recording.velocity)
    samples = {"time": t, "position": position, "velocity": velocity, "acceleration": np.gradient(velocity, t)}
    return SampleFinding(
        name=path.name,
        kind="measurement",
        parameters={parameter: Quantity(path.value, "s", (max(path.value - half, 0.0), path.value + half))},
        equation=EFFECTS[path.name].equation,
        sentence="the measured torque follows its command late, while what the joint pushes against is unknown",
        held=compute_held_out(path.before, path.after, path.errors["history"], (unit, findings.case.seed)),
        series=(_describe_rows(findings.series[0].name, samples, (path.before, path.after)),),
        alike=(other,) if path.errors[other] < LOOK.alike * path.errors[path.name] else (),
        lawless=True,
        rivals=_weigh_drives(path, other, unit),
    )


def _weigh_drives(path: DrivePath, other: str, unit: str) -> tuple[Rival, ...]:
    """The explanations of a late torque; the gain of each is the logarithm of the fall of its error, times samples."""
    best = path.errors[path.name]
    weighed = [
        Rival(
            effects=(name,),
            gain=float(path.before.size * np.log(path.errors["law"] / error)),
            refused="" if name == path.name else f"held-out error {error:.3g} {unit} against {best:.3g}",
        )
        for name, error in path.errors.items()
        if name in (path.name, other, "coulomb")
    ]
    return tuple(sorted(weighed, key=lambda rival: -rival.gain))


def _list_parameters(harmonic: Harmonic, unit: str, position: str) -> dict[str, Quantity]:
    wide = 1.96 * harmonic.order_error
    low, high = max(harmonic.order - wide, 1e-12), harmonic.order + wide
    half = 1.96 * harmonic.amplitude_error
    size = harmonic.amplitude
    return {
        "order": Quantity(harmonic.order, f"1/{position}", (low, high)),
        "period": Quantity(2.0 * np.pi / harmonic.order, position, (2.0 * np.pi / high, 2.0 * np.pi / low)),
        "amplitude": Quantity(size, unit, (max(size - half, 0.0), size + half)),
    }


def _hold_out(findings: Findings, found: Sequence[FineRipple | SoftPresliding]) -> HeldOut:
    """Errors over the samples of all recordings."""
    before, after = (np.concatenate([getattr(one, side) for one in found]) for side in ("before", "after"))
    # Noise of single samples, from the differences of neighbours that nothing smooth explains.
    steps = np.concatenate([np.diff(one.after) for one in found])
    floor = float(np.median(np.abs(steps))) / _STEP
    return compute_held_out(before, after, floor, (findings.case.unit, findings.case.seed))


def compute_held_out(before: FloatArray, after: FloatArray, floor: float, how: tuple[str, int]) -> HeldOut:
    """Compute errors, with the interval of their fall from a bootstrap over blocks.

    Args:
        before: Errors of the samples without the effect [N·m] or [N].
        after: The same with it.
        floor: Noise of a sample.
        how: Unit of torque, and seed of the bootstrap.
    """
    unit, seed = how
    blocks = np.array_split(np.arange(before.size), LOOK.blocks)
    energy = np.array([[float(one[b] @ one[b]) for b in blocks] for one in (before, after)])
    drawn = np.random.default_rng(seed).integers(0, LOOK.blocks, (LOOK.bootstraps, LOOK.blocks))
    falls = 1.0 - np.sqrt(energy[1][drawn].sum(axis=1) / energy[0][drawn].sum(axis=1))
    first, last = (compute_rms(one) for one in (before, after))
    low, high = np.quantile(falls, [0.025, 0.975])
    floor = min(floor, last)
    return HeldOut(
        rmse_before=first,
        rmse_after=last,
        noise_floor=floor,
        unit=unit,
        ci95_reduction=(float(low), float(high)),
        explained=float((first**2 - last**2) / (first**2 - floor**2)),
    )


def _collect_series(findings: Findings, found: Sequence[FineRipple | SoftPresliding]) -> tuple[RowSeries, ...]:
    pairs = zip(findings.series, found, strict=False)
    return tuple(_describe_rows(rows.name, one.samples, (one.before, one.after)) for rows, one in pairs)


def _describe_rows(name: str, samples: dict[str, FloatArray], sides: tuple[FloatArray, FloatArray]) -> RowSeries:
    """Samples with their residual before and after, as rows."""
    time = samples["time"]
    dt = float(np.median(np.diff(time)))
    spread = np.full(time.size, max(float(np.median(np.abs(np.diff(sides[1])))) / _STEP, 1e-12))
    return RowSeries(
        name=name,
        time=time,
        position=samples["position"],
        velocity=samples["velocity"],
        acceleration=samples["acceleration"],
        load_torque=np.zeros(time.size),
        time_since_reversal=measure_time_since_reversal(samples["velocity"], dt),
        temperature=None,
        before=sides[0],
        after=sides[1],
        spread=spread,
    )
