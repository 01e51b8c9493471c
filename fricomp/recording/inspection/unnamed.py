"""What columns without names look like, and a mapping to edit: which one rises as a time, which follow each other."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fricomp.recording.checks.likely_torque import find_likely_torque
from fricomp.recording.checks.position_size import find_sign_bit
from fricomp.recording.named.device_unit import find_rating_parts, is_duty, is_of_axis
from fricomp.recording.named.head_fact import fill_head_facts
from fricomp.recording.named.source import read_layout
from fricomp.recording.named.times.clock import TICK, find_stamps
from fricomp.recording.named.times.row_rate import estimate_row_rate
from fricomp.recording.named.times.stamp_unit import TIME_UNITS, are_known_ticks
from fricomp.recording.sources import is_text
from fricomp.recording.unit import find_unit
from fricomp.recording.validity import Samples

from .mapping_text import describe_source, render_column
from .motor_side import bring_rule_to_joint, is_motors, remark_on_torque
from .stated_unit import find_si, read_stated_unit, read_step
from .worth import fill_worth, measure_worth

_EVENLY = 0.95
"""Part of the steps of a time that are above zero."""
_FOLLOWS = 0.9
"""Correlation of a column with the rate of another one, from which on it is a velocity of it."""
_BLOCKS = 2000
"""Averages of a column that are compared: single samples of an encoder tell no rate."""
_MOST_JOINTS = 12
_FEWEST_SPARSE, _MOST_SPARSE = 0.05, 0.8
"""Part of the rows that have a number of a column with rows of its own."""
_UNSEEN = tuple(f"{one} = {{ column = WHICH }}  # not seen in the numbers" for one in ("position", "torque"))
_FACTORS = tuple(k**sign for k in (1.0, 57.296, 9.5493, 6.2832, 1000.0, 60.0) for sign in (1, -1))
"""How much faster a position moves than its velocity says, where the units of both are in use: rad, deg, turns, rpm."""
_NEAR = 0.08
"""Relative distance within which it is one of them."""
_TWIN = 0.995
"""Correlation with a velocity from which on a column is another one."""
_FAR = 100.0
"""Travel of whole numbers from which on they are counts, and no angles whose sine says anything."""
_MOST_TRIED = 8
"""Columns of which each is tried as the position where none is the rate of another one."""
_NANOSECONDS = 1e9


class GuessedJoint(NamedTuple):
    """Columns that belong together.

    Attributes:
        position: Name of a column.
        velocity: Of the one that is its rate.
        torque: Of the one that inertia, friction and gravity explain best; empty where none is.
        scale: Rate of the position over the velocity [1].
    """

    position: str
    velocity: str
    torque: str
    scale: float


class Guess(NamedTuple):
    """What columns without names may hold.

    Attributes:
        time: Name of the column that rises; empty where none does.
        unit: Of it; empty where it counts ticks of a size that is not known.
        joints: In the order of their positions.
        nanoseconds: Name of the column beside one of whole seconds; empty where the time is one column.
        rate: Rows a second [Hz], where no column is a time and a velocity beside a position tells it; else 0.
        stated: The same, where it stands above the rows.
    """

    time: str
    unit: str
    joints: tuple[GuessedJoint, ...]
    nanoseconds: str = ""
    rate: float = 0.0
    stated: float = 0.0


def guess_columns(columns: Mapping[str, Samples], known: Collection[str] = (), stated: float = 0.0) -> Guess:
    """Guess the time, and pairs of position and velocity, with the torque that moves them.

    Args:
        columns: By name; shape (n_rows,) each.
        known: Names of those that are something else than a torque.
        stated: Rows a second, where the log says it [Hz]; a column that counts rows is no time beside it.
    """
    rows = max((values.size for values in columns.values()), default=0)
    whole = {name: values for name, values in columns.items() if values.size == rows and np.ptp(_finite(values)) > 0.0}
    time, unit, seconds, nanoseconds = _find_time(whole)
    time = "" if time and stated and _counts_rows(whole[time]) else time
    seconds = seconds if time else np.arange(rows, dtype=np.float64) / (stated or 1.0)
    used = (time, nanoseconds)
    seconds, filled = _fill_sparse(seconds, {name: values for name, values in whole.items() if name not in used})
    others = {name: values for name, values in filled.items() if np.isfinite(values).all()}
    pairs = _find_pairs(seconds, others, any_scale=not (time or stated))[:_MOST_JOINTS]
    is_open = bool(pairs) and not (time or stated)
    rate = (estimate_row_rate(others, *pairs[0][:2]) if is_open else None) or 0.0
    seconds = seconds / (rate or 1.0)
    taken = {name for pair in pairs for name in pair[:2]} | set(known)
    left = {name: values for name, values in others.items() if name not in taken}
    joints = [
        GuessedJoint(position, velocity, _find_torque(seconds, others, position, velocity, left), scale * (rate or 1.0))
        for position, velocity, scale in pairs
    ] or (_find_without_velocity(seconds, others, left) if time or stated else [])
    in_order = tuple(sorted(joints, key=lambda one: list(columns).index(one.position)))
    return Guess(time, unit, in_order, nanoseconds, rate, stated)


def _find_time(columns: Mapping[str, Samples]) -> tuple[str, str, Samples, str]:
    """Name, unit and values [s] of the time, and the name of its nanoseconds; an empty name where none rises.

    Ticks of unknown size have no unit, and are the values as they are.
    """
    for name, values in columns.items():
        if _is_time(values) and not (_counts_rows(values) and _says_other(name)):
            if TICK.search(name) and not are_known_ticks(values):
                return name, "", values - values[0], ""
            step = float(np.median(np.diff(values)))
            unit = next(one for most, one in TIME_UNITS if step <= most)
            return name, unit, (values - values[0]) * find_unit(unit).factor, ""
    names = list(columns)
    for first, second in pairwise(names):
        whole, part = columns[first], columns[second]
        if np.isfinite(part).all() and part.min() >= 0.0 and part.max() < _NANOSECONDS and part.max() > 1e8:
            both = (whole - whole[0]) + part / _NANOSECONDS
            if np.all(whole == np.round(whole)) and _is_time(both):
                return first, "s", both, second
    return "", "s", np.zeros(0), ""


def _find_without_velocity(
    time: Samples, columns: Mapping[str, Samples], torques: Mapping[str, Samples]
) -> list[GuessedJoint]:
    """The pair of columns of which one is explained best as the torque that moves the other."""
    if len(columns) > _MOST_TRIED:
        return []
    tried = {
        name: find_likely_torque(time, values, {k: v for k, v in torques.items() if k != name})
        for name, values in columns.items()
    }
    best = max(tried, key=lambda name: tried[name].explained, default="")
    return [GuessedJoint(best, "", tried[best].name, 1.0)] if best and tried[best].name else []


def _fill_sparse(time: Samples, columns: Mapping[str, Samples]) -> tuple[Samples, Mapping[str, Samples]]:
    """Columns that stand in rows of their own, and all others, at even times; as they are where none is such."""
    count = {name: np.count_nonzero(np.isfinite(values)) for name, values in columns.items()}
    sparse = [name for name in columns if _FEWEST_SPARSE * time.size < count[name] < _MOST_SPARSE * time.size]
    if not sparse:
        return time, columns
    even, known = np.linspace(time[0], time[-1], max(count[name] for name in sparse)), np.isfinite(time)
    rows = {name: known & np.isfinite(values) for name, values in columns.items()}
    return even, {name: np.interp(even, time[rows[name]], values[rows[name]]) for name, values in columns.items()}


def _finite(values: Samples) -> Samples:
    finite = values[np.isfinite(values)]
    return finite if finite.size else np.zeros(1)


def _is_time(values: Samples) -> bool:
    if values.size < 10 or not np.isfinite(values).all():
        return False
    steps = np.diff(values)
    return bool(np.mean(steps > 0.0) > _EVENLY and np.abs(steps).max() < 0.5 * np.ptp(values))


def _counts_rows(values: Samples) -> bool:
    return bool(np.all(np.diff(values) == 1.0))


def _says_other(name: str) -> bool:
    """Whether a column has a name, and that of no time: `sample` counts rows."""
    return not name.isdigit() and not find_stamps([name])


def _are_whole(values: Samples) -> bool:
    """Whether a column holds whole numbers alone, as counts are, whose size its rate does not tell."""
    return bool(np.all(values == np.round(values)))


def _find_pairs(time: Samples, columns: Mapping[str, Samples], *, any_scale: bool) -> list[tuple[str, str, float]]:
    """Position, velocity, and how much faster the former moves than the latter says; the surest pairs first.

    Args:
        time: Shape (n_rows,).
        columns: By name; shape (n_rows,) each.
        any_scale: Whether a velocity may be off by any factor, since the rate of the rows is not known.
    """
    width = max(3, time.size // _BLOCKS)
    count = time.size // width
    if count < 20 or len(columns) < 2:
        return []
    names = list(columns)
    blocks = np.stack([columns[name][: count * width].reshape(count, width).mean(axis=1) for name in names])
    middle = time[: count * width].reshape(count, width).mean(axis=1)
    rates = np.gradient(blocks, middle, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        together = np.nan_to_num(np.corrcoef(rates, blocks)[: len(names), len(names) :])
    found: list[tuple[str, str, float]] = []
    for at in np.argsort(-together, axis=None):
        a, b = np.unravel_index(at, together.shape)
        if together[a, b] < _FOLLOWS:
            break
        if a != b and not any(names[k] in pair[:2] for pair in found for k in (a, b)):
            scale = float(rates[a] @ blocks[b] / (blocks[b] @ blocks[b]))
            if (
                any_scale
                or _are_whole(columns[names[a]])
                or any(abs(scale / factor - 1.0) < _NEAR for factor in _FACTORS)
            ):
                found.append((names[a], names[b], scale))
    return found


def render_guess(
    path: Path, guess: Guess, *, numbered: bool, counted: Collection[str] = (), columns: Mapping[str, Samples]
) -> str:
    """A mapping to edit.

    Args:
        path: The log.
        guess: What its columns may hold.
        numbered: Whether they have numbers, and no names.
        counted: Names of columns that hold whole numbers alone: what one is worth has to be said.
        columns: All by name.
    """
    layout = read_layout(path) if path.is_file() and is_text(path) else None

    def rule(channel: str, name: str, velocity: str = "") -> str:
        if numbered:
            return f"{channel} = {{ column = {name} }}"
        unit, is_asked = read_stated_unit(name)
        step = read_step(name, columns[name])
        if step is not None:
            unit = f', unit = "{step.unit}"' if step.unit else ""
            return f"{channel} = {{ column = {render_column(name, layout)}{unit}, scale = {step.scale!r} }}"
        share = find_rating_parts(name, columns) if channel == "torque" else 0
        asked = is_asked or is_of_axis(name) or (name in counted and not unit)
        scale = f"{'SUPPLY' if is_duty(name) else 'RATED'}/{share}" if share else "VALUE_OF_ONE" if asked else ""
        parts = [f"column = {render_column(name, layout)}", *([f'unit = "{unit}"'] if unit else [])]
        signed = find_sign_bit(columns[name]) if channel == "position" and _are_whole(columns[name]) else None
        parts += [f"sign_bit = {signed[0]}"] if signed is not None else []
        line = f"{channel} = {{ {', '.join([*parts, *([f'scale = {scale}'] if scale else [])])} }}"
        line = fill_head_facts(path, line, name)
        if channel != "position" or "VALUE_OF_ONE" not in line or not _are_whole(columns[name]):
            return line
        return fill_worth(line, _measure_worth(columns, guess, name, velocity), velocity)

    lines = [f"# {path.name}: a guess by what the numbers do and the names of its columns say. Correct it.", ""]
    if layout is not None:
        lines += [*describe_source(path, replace(layout, names=()) if numbered else layout), ""]
    lines += ["[metadata]", *_describe_facts(guess), "", "[channels]"]
    if guess.time:
        column = str if numbered else lambda name: render_column(name, layout)
        rest = f", nanoseconds = {column(guess.nanoseconds)}" if guess.nanoseconds else ""
        worth = f'unit = "{guess.unit}"' if guess.unit else "scale = 1/TICKS_A_SECOND"
        lines += [f"time = {{ column = {column(guess.time)}, {worth}{rest}, from_zero = true }}"]
    else:
        by = "; this rate makes one column the velocity of another, if they are in one unit" if guess.rate else ""
        by = ", and this rate stands above the rows" if guess.stated else by
        rate = f"{guess.stated or guess.rate:g}" if guess.stated or guess.rate else "ROWS_A_SECOND"
        lines += [f"time = {{ rate = {rate} }}  # no column is seen to be a time{by}"]
    several = len(guess.joints) > 1
    for number, joint in enumerate(guess.joints, start=1):
        lines += ["", "[[joints]]", f'name = "joint_{number}"'] if several else []
        before = "channels." if several else ""
        position = rule("position", joint.position, joint.velocity)
        scale = joint.scale * _compare_units(joint)
        position = bring_rule_to_joint(path, position) if is_motors(joint.position) else position
        off = abs(scale - 1.0) > 0.2 and "#" not in position and "A_TURN" not in position
        remark = f"  # moves {scale:.4g} times as far as the velocity says: another unit?" if off else ""
        lines += [before + position + remark]
        velocity = rule("velocity", joint.velocity) if joint.velocity else ""
        velocity = bring_rule_to_joint(path, velocity) if is_motors(joint.position) else velocity
        asked = "VALUE_OF_ONE" in velocity  # which no answer needs
        lines += [f"# {before}{velocity}  # where you know it"] if asked else [before + velocity] if velocity else []
        torque = rule("torque", joint.torque) if joint.torque else _UNSEEN[1]
        lines += [before + (remark_on_torque(path, torque, joint.torque) if is_motors(joint.position) else torque)]
    lines += [] if guess.joints else list(_UNSEEN)
    return "\n".join(lines) + "\n"


def _compare_units(joint: GuessedJoint) -> float:
    """What one of the position is over what one of its rate is, where both state their units; else 1."""
    both = [read_stated_unit(name)[0] for name in (joint.position, joint.velocity)]
    return find_unit(both[0]).factor / find_unit(both[1]).factor if all(both) else 1.0


def _find_torque(
    time: Samples, columns: Mapping[str, Samples], position: str, velocity: str, left: Mapping[str, Samples]
) -> str:
    """Find the column that the motion explains best as its torque, leaving out a second velocity."""
    rate, way = columns[velocity], columns[position]
    tried = {name: values for name, values in left.items() if abs(np.corrcoef(values, rate)[0, 1]) < _TWIN}
    counts = _are_whole(way) and np.ptp(way) > _FAR
    return find_likely_torque(time, way / np.ptp(way) if counts else way, tried).name


def _measure_worth(columns: Mapping[str, Samples], guess: Guess, position: str, velocity: str) -> float:
    """What one of a position in counts is, by the velocity beside it; 0 where nothing tells it."""
    if not velocity:
        return 0.0
    rows = np.arange(columns[position].size, dtype=np.float64)
    rate = guess.stated or guess.rate
    if guess.time and not guess.nanoseconds and guess.unit:
        time = columns[guess.time] * find_unit(guess.unit).factor
    elif rate:
        time = rows / rate
    else:
        return 0.0
    return measure_worth(time, columns[position], columns[velocity], velocity)


def _describe_facts(guess: Guess) -> list[str]:
    """Unit of the torque and kind of the motion, by the units that the names state; else those of a rotary joint."""
    stated = {find_si(name) for joint in guess.joints for name in (joint.position, joint.torque)}
    unit = next((one for one in ("A", "V", "N") if one in stated), "N·m")
    motion = "linear" if stated & {"m", "N"} else "rotary"
    return [
        f'torque_unit = "{unit}"  # "A" of a current, "N" of a force, "V" of a voltage, "N·m" of a torque',
        f'motion = "{motion}"  # "linear" of a slide, "rotary" of a joint that turns',
    ]
