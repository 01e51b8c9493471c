"""Which links and friction are written, and what the files are worth joint by joint.

Torques say little of what a link weighs where it hardly accelerates, and an open-loop simulation hangs on just that:
an arm of small inertia runs away from errors that are small as torques. So the links as they were found, and links that
stay nearer the simulation wherever the motion says little, are both simulated on the blocks that they were fitted to.
No file holds a gear that gives way: where one was found, links that make up for it as far as rigid ones can are tried
as well. Those that go least wrong are written, and measured on the other blocks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.control.compensation.choice import DEFAULT_GAIN
from fricomp.errors import FricompError
from fricomp.evaluation import ArmEvaluation
from fricomp.evaluation.arm import JointErrors
from fricomp.evaluation.settings import HORIZONS

from ..answer import ArmAnswer
from ..coordinates import ArmModel
from ..fit import ArmFit, fit_arm
from ..friction import GEARS, TERMS
from ..identification import ArmIdentification
from ..matter import LEAST_MATTER
from ..prior import ArmPrior
from ..record import ArmRecord, FileErrors, JointRecord
from ..row_weights import BoolArray
from ..search.gear import YIELDING_GEAR
from ..words.quantity import show_quantity
from .evaluation import FileTrial, compare_files, hold_out

_NEARER = 0.3
"""Part of the prior's deviation that links that stay nearer the simulation may depart from it by."""

_CLEARLY = 0.98
"""Error of another choice, in that of the links as they were found, below which it is written."""

_LONGEST = 0.5
"""[s] of the open-loop simulations that decide, and of those whose errors are told in words."""

_WORSE = 1.1
"""Torque error of the files over that of the fit from which both are told."""

_FEW_STEPS, _STEPS = 5, 20
"""Gauss-Newton steps of the answer, fitted to a part of the recording, and of another choice, which lies further from
the fit that it starts at."""

_NEAR_NOTE = (
    "In arm.xml and the friction models the links stay nearer the simulation than in this answer: in open-loop "
    "simulation that goes less wrong."
)
_RIGID_NOTE = (
    "arm.xml and the friction models hold no gear that gives way: their links make up for it as far as rigid ones can, "
    "and are not those of this answer."
)


@dataclass(frozen=True)
class WrittenFiles:
    """What `arm.xml` and the friction models are made of, and what that is worth.

    Attributes:
        answer: With the links and friction that are written.
        errors: Of each joint on held-out data; empty where the recording is too short.
        notes: How what is written differs from the answer, in sentences.
        held_out: The same errors with their intervals, of the files alone; None where the recording is too short.
        without: Of joints in which something is named, by files that are made without it.
        whole: Errors of the files as they are written, over the whole recording; torque alone.
    """

    answer: ArmAnswer
    errors: Mapping[str, FileErrors]
    notes: tuple[str, ...] = ()
    held_out: ArmEvaluation | None = None
    without: Mapping[str, JointErrors] = field(default_factory=dict)
    whole: ArmEvaluation | None = None


@dataclass(frozen=True)
class _Choice:
    """Links and friction that may be written.

    Attributes:
        model: What is fitted.
        prior: How far the simulation is trusted for it.
        notes: How that differs from the answer, in sentences.
        steps: Gauss-Newton steps from the answer.
    """

    model: ArmModel
    prior: ArmPrior
    notes: tuple[str, ...]
    steps: int

    def fit(self, found: ArmIdentification, rows: BoolArray) -> ArmFit:
        """Fit it to some of the rows."""
        if not self.notes and np.all(rows):
            return found.fit
        return fit_arm(
            found.fit.arm, found.equations.with_rows(rows), self.model, self.prior, found.fit, steps=self.steps
        )


@one_blas_thread()
def prepare_files(answer: ArmAnswer, simulation: str | Path) -> WrittenFiles:
    """Choose what is written, and measure it on held-out blocks.

    Args:
        answer: The confirmed fit.
        simulation: The file that was compared.
    """
    found = answer.identification
    held, spans, others = hold_out(found.rows.time)
    best = _choose(FileTrial(answer, Path(simulation), ~held, others, _LONGEST), _list_choices(found))
    written = replace(answer, identification=replace(found, fit=best.fit(found, np.ones_like(held))))
    made = WrittenFiles(written, {}, best.notes)
    trial = FileTrial(answer, Path(simulation), ~held, spans, HORIZONS[-1])
    with suppress(FricompError, ValueError):  # no stretch of the recording that an open-loop simulation fits into
        return _measure(made, trial, best.fit(found, ~held), best.prior)
    return made


def _list_choices(found: ArmIdentification) -> list[_Choice]:
    """What may be written, the answer itself first."""
    model, nearer = found.fit.model, replace(found.prior, links=_NEARER * found.prior.links)
    choices = [
        _Choice(model, found.prior, (), _FEW_STEPS),
        _Choice(replace(model, opened=frozenset()), nearer, (_NEAR_NOTE,), _STEPS),
    ]
    if YIELDING_GEAR in {name for form in model.forms for name in form.names}:
        forms = tuple(form.without_term(YIELDING_GEAR) for form in model.forms)
        choices += [
            _Choice(replace(one.model, forms=forms), one.prior, (*one.notes, _RIGID_NOTE), _STEPS) for one in choices
        ]
    return choices


def _measure(made: WrittenFiles, trial: FileTrial, fit: ArmFit, prior: ArmPrior) -> WrittenFiles:
    """What the files are worth: held out, without what is named in a joint, and as they are written.

    Args:
        made: Without errors.
        trial: On held-out blocks.
        fit: What files are made of without these blocks.
        prior: How far the simulation was trusted for it.
    """
    after = trial.evaluate_fit(fit)
    whole = replace(trial, spans=None, longest=0.0)
    named = {j: trial.answer.list_named(j) for j in range(len(fit.arm.joints))}
    equations = trial.answer.identification.equations.with_rows(trial.trained)
    less = {
        fit.arm.joints[j]: fit_arm(fit.arm, equations, fit.model.without_terms(j, *names), prior, fit)
        for j, names in named.items()
        if names
    }
    return replace(
        made,
        errors=compare_files(trial, fit, trial.evaluate_plain(), after),
        held_out=after,
        without={name: trial.evaluate_fit(one).joint(name) for name, one in less.items()},
        whole=whole.evaluate_fit(made.answer.identification.fit),
    )


def add_file_errors(record: ArmRecord, written: WrittenFiles) -> ArmRecord:
    """The record with what the files of each joint are worth; as it was where the recording is too short for it."""
    from msgspec.structs import replace as change

    joints = tuple(change(joint, files=written.errors.get(joint.name)) for joint in record.joints)
    return change(
        record,
        joints=joints,
        sentences=(*record.sentences, *written.notes, *_say_files(joints)),
        summary=(*record.summary, *_warn_in_short(joints)),
    )


def _choose(trial: FileTrial, choices: Sequence[_Choice]) -> _Choice:
    """The choice that goes least wrong; the first where none goes clearly less wrong, or nobody can tell."""
    found = trial.answer.identification
    try:
        before = trial.evaluate_plain()
        scores = [_score(before, trial.evaluate_fit(one.fit(found, trial.trained))) for one in choices]
    except (FricompError, ValueError):
        return choices[0]
    best = int(np.argmin(scores))
    return choices[best if scores[best] < _CLEARLY * scores[0] else 0]


def _score(before: ArmEvaluation, after: ArmEvaluation) -> float:
    """Geometric mean over joints of their errors, in those of the simulation: torque, and position after each time."""
    ratios = []
    for old, new in zip(before.joints, after.joints, strict=True):
        moved = [b.median / max(a.median, 1e-300) for a, b in zip(old.position, new.position, strict=True)]
        ratios += [new.torque.rms / max(old.torque.rms, 1e-300), *moved]
    return float(np.exp(np.mean(np.log(np.maximum(ratios, 1e-300)))))


def _say_files(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """How far the written files go wrong, where they are no better, and which hold less than the fit."""
    lines = []
    known = [(joint, joint.files) for joint in joints if joint.files is not None]
    times = [tuple(each for each in files.positions if each.after == _LONGEST) for _, files in known]
    if known and all(times):
        parts = ", ".join(
            f"{joint.name} {1e3 * at.simulation:.3g} to {1e3 * at.files:.3g} m{at.unit}"
            for (joint, _), (at,) in zip(known, times, strict=True)
        )
        lines.append(
            f"Simulated for {_LONGEST:g} s from measured states with the recorded torques, on held-out data, the "
            f"median position error changes from the simulation with Coulomb and viscous friction to these files: "
            f"{parts}."
        )
    lines += _say_gains(known)
    for joint, files in known:
        lines += _say_worse(joint, files)
        if files.torque > _WORSE * files.torque_fit:
            geared = any(TERMS[one.name].filled in GEARS for one in joint.effects if one.name in TERMS)
            lacking = ", and no gear that gives way" if geared else ""
            lines.append(
                f"{joint.name}: the files hold less than the fit{lacking}; their held-out torque error is "
                f"{files.torque:.3g} {joint.unit}, that of the fit {files.torque_fit:.3g} {joint.unit}."
            )
    return tuple(lines)


def _say_gains(known: Sequence[tuple[JointRecord, FileErrors]]) -> list[str]:
    """Which part of the friction of the files a compensator could have taken on held-out data."""
    gains = [f"{joint.name} {show_quantity(files.best_gain)}" for joint, files in known if files.best_gain is not None]
    if not gains:
        return []
    return [
        f"On held-out data these parts of the friction in the files would have been compensated best: "
        f"{', '.join(gains)}. ArmCompensator takes {DEFAULT_GAIN:g} of it, so as not to push where there is less; "
        "gain=... of `ArmCompensator.read` takes another part."
    ]


def _warn_in_short(joints: Sequence[JointRecord]) -> tuple[str, ...]:
    """Where the files of joints are no better, as the terminal has it."""
    worse = [
        f"{joint.name} {' and '.join(found)}"
        for joint in joints
        if joint.files is not None and (found := _find_worse(joint, joint.files))
    ]
    if not worse:
        return ()
    return (f"But the files are no better than the simulation with Coulomb and viscous friction: {'; '.join(worse)}.",)


def _find_worse(joint: JointRecord, files: FileErrors) -> list[str]:
    """Where files are no better than the simulation though something is named, or worse by what matters."""
    level, worse = joint.friction["coulomb"].value, []
    if _is_worse(joint, files.torque, files.torque_simulation, level):
        worse.append(f"in torque ({files.torque_simulation:.3g} to {files.torque:.3g} {joint.unit})")
    for at in files.positions:
        if at.after <= _LONGEST and _is_worse(joint, at.files, at.simulation, at.travel):
            moved = f"{1e3 * at.simulation:.3g} to {1e3 * at.files:.3g} m{at.unit}"
            worse.append(f"simulated for {at.after:g} s ({moved})")
    return worse


def _is_worse(joint: JointRecord, files: float, simulation: float, size: float) -> bool:
    """Whether an error of the files is told, beside that of the simulation and the size of what is erred in.

    Where nothing is missing, two right answers differ by chance.
    """
    least = 0.0 if joint.effects else LEAST_MATTER * size
    return files - simulation >= least


def _say_worse(joint: JointRecord, files: FileErrors) -> list[str]:
    """Where the files of a joint are no better than its simulation with Coulomb and viscous friction."""
    worse = _find_worse(joint, files)
    if not worse:
        return []
    lost = "Do not simulate it by them without a controller. " if len(worse) > 1 or "simulated" in worse[0] else ""
    return [
        f"{joint.name}: the files are no better than the simulation with Coulomb and viscous friction "
        f"{' and '.join(worse)}. {lost}".rstrip()
    ]
