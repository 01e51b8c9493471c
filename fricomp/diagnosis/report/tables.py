"""What was found as tables: effects, errors before and after, parameters that changed, the base model."""

from __future__ import annotations

from fricomp.report import Table

from ..record.file_errors import ModelErrors
from ..record.result import FRICTION_CHANGES, DiagnosisRecord, Quantity
from .over_time import BASE, NAMED, name_models
from .wording import (
    Units,
    derive_parameters,
    describe_name,
    format_interval,
    format_location,
    format_number,
    format_quantity,
)

_BASE = f"{BASE}: rigid joint and friction, refitted"


def build_effect_table(record: DiagnosisRecord) -> Table | None:
    """Every named effect with its parameters, its share and its aliases; None where nothing was named.

    The unit stands behind the value: a terminal has no room for a column of it.
    """
    rows: list[tuple[str, ...]] = []
    for effect in record.effects:
        share = f"{effect.share:.0%}"
        aliases = ", ".join(effect.indistinguishable_from) or "–"
        head: tuple[str, ...] = (effect.name,)
        rest = (share, aliases)
        for name, quantity in derive_parameters(effect).items():
            known = f"{effect.name}.{name}" not in record.undetermined
            rows.append((*head, describe_name(name), *_format_value(quantity, determined=known), *rest))
            head, rest = ("",), ("", "")
        if not effect.parameters:
            rows.append((*head, "–", "–", "–", *rest))
    columns = ("effect", "parameter", "value", "95 % interval", "share", "cannot be told from")
    return Table(columns, tuple(rows)) if rows else None


def build_brief_effect_table(record: DiagnosisRecord) -> Table | None:
    """The same for a terminal: no share, no aliases, and of a ripple its amplitude and order alone."""
    rows: list[tuple[str, ...]] = []
    for effect in record.effects:
        head = effect.name
        found = derive_parameters(effect)
        for name, quantity in found.items():
            wave = name.removeprefix("sine").removeprefix("cosine")
            if (wave != name and f"amplitude{wave}" in found) or (name == "period" and "order" in found):
                continue
            known = f"{effect.name}.{name}" not in record.undetermined
            rows.append((head, describe_name(name), *_format_value(quantity, determined=known)))
            head = ""
    return Table(("effect", "parameter", "value", "95 % interval"), tuple(rows)) if rows else None


def _format_value(quantity: Quantity, *, determined: bool) -> tuple[str, str]:
    """Value with its unit, where there is one, and the interval."""
    if not determined:
        return "not determined", format_interval(quantity)
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    value = format_number(quantity.value, 0.5 * (quantity.ci95[1] - quantity.ci95[0]) or None)
    return value + unit, format_interval(quantity)


def build_error_table(record: DiagnosisRecord) -> Table | None:
    """Errors of the models that are written, on held-out data and over all of it; None where none is written."""
    found = record.errors
    if found is None:
        return None
    before, *after = name_models(record)
    times = [one.after for one in found.before.position]
    position = found.before.position[0].unit if times else ""
    rows = [_list_errors(_BASE if before == BASE else before, found.before, len(times))]
    if found.after is not None:
        rows += [_list_errors(name, found.after, len(times)) for name in after]
    rows.append(_list_errors("friction.json, over all data", found.file, len(times)))
    torque = found.file.torque
    columns = (
        "error on held-out data",
        f"torque, RMS [{torque.unit}]",
        "95 % interval",
        "median",
        *(f"position after {time:g} s [{position}]" for time in times),
    )
    caption = (
        f"Torque in the band from 0 to {torque.band:g} Hz, while the joint moves: {torque.recorded:.4g} {torque.unit} "
        f"RMS were recorded. {_describe_folds(found.folds)} Positions: "
        "medians of open-loop simulations under the recorded torque, from measured states. fricomp evaluate measures "
        "the same."
    )
    return Table(columns, tuple(rows), caption)


def _describe_folds(folds: int) -> str:
    """How data were left out: in turn, or once."""
    if folds == 1:
        return "A part of the data by a model fitted to the rest."
    return f"Each of {folds} folds of the data by a model fitted to the others."


def _list_errors(name: str, errors: ModelErrors, times: int) -> tuple[str, ...]:
    torque, (low, high) = errors.torque, errors.torque.ci95_rms
    positions = [f"{one.median:.3g}" for one in errors.position] or ["–"] * times
    return (name, f"{torque.rms:.4g}", f"{low:.4g} to {high:.4g}", f"{torque.median:.4g}", *positions)


def build_residual_table(record: DiagnosisRecord) -> Table | None:
    """Whitened residual before and after beside its noise floor; None where nothing could be simulated."""
    found = record.heldout
    if found is None:
        return None
    low, high = found.ci95_reduction
    before, *after = name_models(record)
    rows: list[tuple[str, ...]] = [(_BASE if before == BASE else before, f"{found.rmse_before:.4g}", "–")]
    rows += [(name, f"{found.rmse_after:.4g}", f"{low:.0%} to {high:.0%}") for name in after]
    rows.append(("noise floor: nothing missing", f"{found.noise_floor:.4g}", "–"))
    caption = "What the verdict rests on: rows of the fit on held-out blocks, each counted by its own noise."
    columns = ("whitened residual", f"RMS [{found.unit}]", "falls by (95 % interval)")
    width = 3 if record.effects else 2
    return Table(columns[:width], tuple(row[:width] for row in rows), caption)


def build_forward_table(record: DiagnosisRecord) -> Table | None:
    """Position error of the explanation in its loop, before and after; None where none was simulated."""
    found = record.forward
    if found is None:
        return None
    rows: list[tuple[str, ...]] = [(_BASE, f"{found.rmse_before:.4g}")]
    if name_models(record)[-1] == NAMED:
        rows.append((NAMED, f"{found.rmse_after:.4g}"))
    low, high = found.interval
    caption = (
        f"The explanation itself, not its files, in MuJoCo under the recorded reference from {low:.3g} to {high:.3g} "
        f"s, which the fit did not see. {found.controller}."
    )
    return Table(("position error in closed loop", f"RMS [{found.unit}]"), tuple(rows), caption)


def build_change_table(record: DiagnosisRecord) -> Table | None:
    """Parameters of the given simulation that the refit moved; None where there are none."""
    rows = tuple(
        (
            describe_name(change.name),
            format_number(change.given),
            format_number(change.refitted.value),
            format_interval(change.refitted),
            change.refitted.unit,
        )
        for change in record.changes
    )
    friction = any(change.name in FRICTION_CHANGES for change in record.changes)
    caption = "Friction is identified from the recording: that of the simulation is no part of the verdict."
    columns = ("parameter", "given", "refitted", "95 % interval", "unit")
    return Table(columns, rows, caption if friction else "") if rows else None


def build_base_table(record: DiagnosisRecord) -> Table | None:
    """Parameters of the refitted base model."""
    rows = tuple(
        (describe_name(name), format_quantity(quantity, determined=name not in record.undetermined))
        for name, quantity in record.base.items()
    )
    return Table(("parameter", "value"), rows, "The simulation, with its parameters refitted.") if rows else None


def build_location_table(record: DiagnosisRecord, units: Units) -> Table | None:
    """Where the mismatch sits, and where each effect acts."""
    alone = len(record.effects) == 1 and record.effects[0].location == record.location
    rows = [("the whole mismatch", format_location(record.location, units))] if record.location and not alone else []
    rows += [(effect.name, format_location(effect.location, units)) for effect in record.effects if effect.location]
    return Table(("what", "where"), tuple(rows)) if rows else None
