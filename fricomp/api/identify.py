"""`fricomp.identify`: friction from a recording, or from a table of velocity and torque."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from fricomp.calibration import IdentificationOptions, choose_law
from fricomp.calibration import identify as identify_points
from fricomp.calibration.identification import IdentificationResult, fit_discrepancy
from fricomp.calibration.identification.estimation.form import separable_law_names
from fricomp.calibration.identification.exponent import FIXED_LAW, FREE_LAW, asks_for_exponent, is_shown
from fricomp.calibration.identification.identify import refuse_dynamic, require_choice
from fricomp.calibration.table import is_friction_table, read_friction_table
from fricomp.errors import IdentificationError
from fricomp.recording import Recording
from fricomp.recording.checks.degrees import suspect_degrees_per_second
from fricomp.recording.file import is_motion, take_recording

from .identification import Identification
from .identify_settings import IdentifySettings
from .motion_friction import identify_recording
from .motion_law import USUAL_LAW

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["IdentifySettings", "identify", "identify_source"]


@dataclass(frozen=True)
class _Points:
    """A table of friction points, and what to call it."""

    name: str
    velocity: ArrayLike
    torque: ArrayLike
    normal_load: ArrayLike | None
    torque_unit: str = ""


def identify(
    data: Recording | str | os.PathLike[str] | Mapping[str, ArrayLike] | DataFrame | ArrayLike,
    torque: ArrayLike | None = None,
    normal_load: ArrayLike | None = None,
    *,
    law: str = "",
    method: Literal["pinn", "least_squares"] = "pinn",
    noise: str | ArrayLike = "auto",
    loss: Literal["gaussian", "robust"] = "gaussian",
    gravity: bool | None = None,
    depart: bool = False,
    seed: int = 0,
    options: IdentificationOptions | None = None,
) -> Identification:
    """Identify the friction of a joint from data that you have already; nothing moves.

    A table is friction alone: points of velocity and torque, as a sweep gives them. The law that is looked for is

        tau(v) = sign(v) (F_c + (F_s - F_c) exp(-(v / v_s)²)) + sigma_2 v

    with a set of parameters for each direction, at the greatest likelihood of the points. A recording is a motion of
    any kind: there the joint obeys

        tau = J a + g_c cos(q) + g_s sin(q) + tau_0 + tau_friction(v),

    and inertia, gravity, offset and friction are fitted together, from the samples that slide.

    Args:
        data: A recording, or the file of one; or a table: a CSV file with the columns velocity, torque and if wanted
            normal_load, a mapping or data frame with such columns, or the velocities [rad/s] or [m/s], shape (n,).
        torque: Friction torque where `data` are velocities, with the sign of the velocity [N·m] or [N]. Shape (n,).
        normal_load: Normal load of these points, where dry friction depends on it. Shape () or (n,).
        law: As it is, `stribeck`, of a table that asks for another exponent than 2 `free_stribeck`, and of a recording
            that does not determine its eight parameters `symmetric_stribeck`, `asymmetric_coulomb_viscous` or
            `coulomb_viscous` where that is as good. Or by name: `stribeck`, with eight parameters; `free_stribeck`,
            with an exponent of each direction besides; fewer where the data hold less: `symmetric_stribeck` where both
            directions are alike, `asymmetric_coulomb_viscous`, `coulomb_viscous` or `coulomb` where nothing slow
            was measured, `tanh` or `arctan` for a curve without a step; of tables `auto`, which compares them on points
            that were held out.
        method: `pinn` trains the paper's network together with the parameters; `least_squares` is quicker and has the
            same optimum. For tables.
        noise: `absolute` where the torque sensor sets it, `relative` where it grows with the torque, `auto` to decide
            by likelihood; or one standard deviation a point [N·m] or [N]. For tables.
        loss: `robust` where single points may be far off; it costs a little accuracy where none is. For tables.
        gravity: Whether gravity acts on the joint and is fitted; where it is not said, it is fitted if most of the
            torque that is unexplained without it goes with sine and cosine of the angle. For recordings.
        depart: Let a network leave the law where points that were held out ask for it. For tables.
        seed: Of the network's first weights. For tables.
        options: Name, motion and torque unit of the joint of a table, and further settings; a recording says its own.

    Raises:
        IdentificationError: The data do not suffice, an argument does not apply to them, or a value is unknown.
        RecordingError: A file cannot be read, or the recording cannot be used as it is.
    """
    settings = IdentifySettings(method, noise, loss, law, gravity, seed, depart)
    source: Any = take_recording(data) if torque is None and is_motion(data) else data
    if torque is not None:
        if isinstance(data, Recording | str | os.PathLike):
            raise IdentificationError("torque belongs to velocities: leave it out beside a recording or a file")
        source = {"velocity": data, "torque": torque, "normal_load": normal_load}
    return identify_source(source, settings, options)


def identify_source(
    source: Recording | str | os.PathLike[str] | Mapping[str, Any],
    settings: IdentifySettings,
    options: IdentificationOptions | None = None,
    *,
    flag: str = "",
) -> Identification:
    """Identify a recording or a table.

    Args:
        source: See `identify`.
        settings: How.
        options: Of a table.
        flag: What stands before the name of an argument in messages, such as `--` on the command line.

    Raises:
        FricompError: See `identify`.
    """
    require_law(settings.law or USUAL_LAW)
    points = _points_of(source)
    if points is None:
        return identify_recording(source, settings, flag)  # type: ignore[arg-type]
    if settings.gravity is not None:
        what = f"{points.name} is a table, which is friction alone"
        raise IdentificationError(f"{flag}gravity is for recordings; {what}: leave it out")
    chosen = options or IdentificationOptions()
    if points.torque_unit not in ("", "N·m") and chosen.torque_unit == IdentificationOptions().torque_unit:
        chosen = replace(
            chosen, torque_unit=points.torque_unit, motion="linear" if points.torque_unit == "N" else chosen.motion
        )
    return _identify_table(points, settings, chosen)


def require_law(law: str) -> None:
    """Refuse a law that no file can be identified with.

    Raises:
        IdentificationError: It is unknown, or has a state and needs the torque over time.
    """
    refuse_dynamic(law)
    require_choice("law", law, ("auto", *separable_law_names()))


def _points_of(source: object) -> _Points | None:
    """The table that a source is or names; None for a recording."""
    if isinstance(source, Recording):
        return None
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        return _Points(path.name, *read_friction_table(path)) if is_friction_table(path) else None
    if isinstance(source, list | tuple) and any(isinstance(one, Recording | str | os.PathLike) for one in source):
        raise IdentificationError(
            "several recordings were given: identify takes one; compare or watch take their models"
        )
    table: Any = source if isinstance(source, Mapping) or hasattr(source, "columns") else {}
    missing = [name for name in ("velocity", "torque") if name not in table]
    if missing:
        raise IdentificationError(
            f"{missing[0]} is missing: give velocities and torques, a table with the columns velocity and torque, a "
            "Recording, or the path of a file"
        )
    velocity, torque, load = (table.get(name) for name in ("velocity", "torque", "normal_load"))
    return _Points("the table", np.asarray(velocity), np.asarray(torque), None if load is None else np.asarray(load))


def _identify_table(points: _Points, settings: IdentifySettings, options: IdentificationOptions) -> Identification:
    speed = np.abs(np.asarray(points.velocity, dtype=np.float64))
    fast = suspect_degrees_per_second(float(np.max(speed, initial=0.0)))
    notes, law = [finding.caution for finding in fast], settings.law or USUAL_LAW
    if law == "auto":
        choice = choose_law(points.velocity, points.torque, points.normal_load)
        notes.append(f"Law: {choice.reason}.")
        law = choice.law
    result = _fit_points(points, settings, law, options)
    if not settings.law:
        result, said = _with_exponent(result, points, settings, options)
        notes += said
    notes += _offset_note(result)
    network = fit_discrepancy(result, seed=settings.seed) if settings.depart else None
    notes += [f"Law or network: {network.message}."] if network is not None else []
    return Identification(result, None, network, tuple(notes), settings.to_facts(points.name))


def _fit_points(
    points: _Points, settings: IdentifySettings, law: str, options: IdentificationOptions
) -> IdentificationResult:
    return identify_points(
        points.velocity, points.torque, points.normal_load, settings.method, settings.noise, settings.seed,
        law=law, loss=settings.loss, options=options,
    )  # fmt: skip


def _with_exponent(
    result: IdentificationResult, points: _Points, settings: IdentifySettings, options: IdentificationOptions
) -> tuple[IdentificationResult, list[str]]:
    """The result with the exponents of its curves free, where the points ask for others than 2; and what is said."""
    if options.start is not None or not asks_for_exponent(result):
        return result, []
    try:
        free = _fit_points(points, settings, FREE_LAW, options)
    except IdentificationError:  # too few points for two parameters more
        return result, []
    if not is_shown(result, free):
        return result, []
    gain = result.negative_log_likelihood - free.negative_log_likelihood
    return free, [f"Law: {FREE_LAW}, the exponents free, which fits better than {FIXED_LAW} by {gain:.3g} nats."]


def _offset_note(result: IdentificationResult) -> list[str]:
    """What a table cannot tell, where the law has a curve for each direction."""
    offset = result.observations.compute_asymmetry() if result.form.bidirectional else None
    if offset is None:
        return []
    return [
        "A constant torque offset in the table counts as friction that differs between the directions; with the same "
        f"friction in both it would be {offset:.4g} {result.model.torque_unit}."
    ]
