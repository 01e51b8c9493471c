"""Settings chosen from the model and the loop it works in."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from fricomp.control.compensation.authority import compute_authority, find_acceleration_range, find_temperature_range
from fricomp.control.compensation.confidence import compute_confident_gain
from fricomp.control.compensation.curve import FrictionCurves, split_law
from fricomp.control.compensation.limit_cycle import HIGHEST_GAIN, LIMIT_CYCLE_MARGIN, find_gain_limit
from fricomp.control.compensation.trust import LARGEST_EXTRAPOLATION, bound_friction, find_doubt
from fricomp.control.settings import CompensationSettings, LoopDynamics, Source
from fricomp.errors import ParameterError
from fricomp.model import FrictionModel

# Above this F_s/F_c the falling branch decides the motion at reversals; with a loop given, its damping decides.
_STICK_SLIP_RATIO = 2.0
_SHARES = (1.0, 0.75, 0.5, 0.25)
_DEFAULT_SHARE = 0.5
# The describing function was up to a quarter above the simulated limit cycle, so the choice asks for more than 15 %.
_PREDICTED_MARGIN = 1.25 * LIMIT_CYCLE_MARGIN
_CURE = "try a shorter delay or another bandwidth in fricomp check-loop"
_LOWEST_GAIN = 0.5
DEFAULT_GAIN = 0.95
_HIGHEST_GAIN = 0.98


def choose_settings(
    model: FrictionModel, *, loop: LoopDynamics | None = None, velocity_quantum: float = 0.0, **given: Any
) -> CompensationSettings:
    """Settings that fit `model` and `loop`; `given` fields of `CompensationSettings` are taken as they are.

    Args:
        model: Identified friction.
        loop: The position loop around the joint; without it the choice rests on the model alone.
        velocity_quantum: Step of the measured velocity [rad/s] or [m/s].
        given: Fields that are not to be chosen.

    Raises:
        ParameterError: A value is outside its domain or of another kind, or an unknown field is given.
    """
    _refuse_unknown(given)
    given_model, model = model, bound_friction(model)
    curves = split_law(model.law)
    velocity_range, range_notes = _choose_velocity_range(model, curves)
    gain, gain_notes = _choose_gain(model, velocity_range)
    authority, authority_notes = compute_authority(model, curves, velocity_range)
    source, source_notes = _choose_source(curves, loop, f"{model.torque_unit}·s/{model.position_unit}")
    source = given.get("source", source)
    top = max(abs(edge) for edge in velocity_range)
    smoothing = curves.smoothing or min(0.01 * top, 0.1 * (curves.stribeck_velocity or math.inf))
    is_measured = source == "measured"
    chosen = CompensationSettings(
        source=source,
        measured_share={"reference": 0.0, "blend": _DEFAULT_SHARE, "measured": 1.0}.get(source, 0.0),
        smoothing=max(smoothing, 3.0 * velocity_quantum) if is_measured else smoothing,
        gain=gain,
        authority=authority,
        velocity_range=velocity_range,
        fade_width=0.5 * top,
        dead_band=1.5 * velocity_quantum if is_measured else 0.0,
        normal_load_range=model.validity.normal_load,
        load_torque_range=model.validity.load_torque,
        temperature_range=find_temperature_range(model, curves),
        acceleration_range=find_acceleration_range(model, curves, velocity_range),
    )
    try:
        chosen = replace(chosen, **given)
    except TypeError as error:
        raise ParameterError(f"a setting is of the wrong kind ({error}) in {given!r}") from error
    found = {"source": source_notes, "gain": gain_notes, "authority": authority_notes}
    notes = [
        *_list_doubts(given_model, model),
        *range_notes,
        *(note for name, said in found.items() if name not in given for note in said),
    ]
    if loop is not None:
        chosen, margin_notes = _with_margin(curves, loop, chosen, given)
        notes += margin_notes
    return replace(chosen, notes=tuple(notes))


def _refuse_unknown(given: Iterable[str]) -> None:
    known = [name for name in CompensationSettings.__dataclass_fields__ if name != "notes"]
    if unknown := sorted(set(given) - set(known)):
        raise ParameterError(f"unknown setting {', '.join(unknown)}; known: {', '.join(known)}")


def _with_margin(
    curves: FrictionCurves, loop: LoopDynamics, chosen: CompensationSettings, given: dict[str, Any]
) -> tuple[CompensationSettings, list[str]]:
    """`chosen`, changed so that it keeps its distance to the limit cycle, where that is possible."""
    stuck = [f"nothing keeps gain {chosen.gain:.3g} free of a limit cycle with this loop and its delay: {_CURE}"]
    if chosen.source != "reference":
        return _keep_margin(curves, loop, chosen, given) or (chosen, stuck)
    # A reference has no part in the loop, but a late damping may still not hold the falling branch.
    if "source" in given or curves.steepest_fall == 0.0 or find_gain_limit(curves, loop, chosen) > 0.0:
        return chosen, []
    followed = _keep_margin(curves, loop, replace(chosen, source="blend"), given)
    if followed is None:
        return chosen, stuck
    late = (
        "the loop's damping comes too late to hold the falling branch: part of the speed is taken from the measurement"
    )
    return followed[0], [late, *followed[1]]


def _keep_margin(
    curves: FrictionCurves, loop: LoopDynamics, chosen: CompensationSettings, given: dict[str, Any]
) -> tuple[CompensationSettings, list[str]] | None:
    """The largest measured share, and if need be a lower gain, that keeps the margin; None if there is none."""
    shares = (chosen.measured_share,) if {"measured_share", "source"} & set(given) else _SHARES
    limits = []
    for share in shares:
        limits.append(find_gain_limit(curves, loop, replace(chosen, measured_share=share)))
        if chosen.gain * _PREDICTED_MARGIN <= limits[-1]:
            found = f"a limit cycle would start at gain {limits[-1]:.2f}"
            if limits[-1] >= HIGHEST_GAIN:
                found = f"no limit cycle was found up to gain {HIGHEST_GAIN:g}"
            return replace(chosen, measured_share=share), [f"measured share {share:g}: {found}"]
    limit, share = max(zip(limits, shares, strict=True))
    if limit == 0.0 or "gain" in given:
        return None
    lowered = replace(chosen, measured_share=share, gain=limit / _PREDICTED_MARGIN)
    # The limit was looked for from the higher gain on: a lower one may leave the fall of friction to a late damping.
    if find_gain_limit(curves, loop, lowered) < LIMIT_CYCLE_MARGIN * lowered.gain:
        return lowered, [f"gain lowered to {lowered.gain:.2f}, at which the loop may still oscillate: {_CURE}"]
    return lowered, [f"gain lowered to {lowered.gain:.2f}: a limit cycle would start at gain {limit:.2f}"]


def _list_doubts(given: FrictionModel, bounded: FrictionModel) -> list[str]:
    doubt, notes = find_doubt(given), []
    if doubt is not None:
        notes.append(f"the model is not usable: {doubt}")
    if bounded is not given:
        notes.append(
            f"below the slowest speed measured its friction is held to {LARGEST_EXTRAPOLATION:g} times the largest "
            "that was measured"
        )
    return notes


def _choose_velocity_range(model: FrictionModel, curves: FrictionCurves) -> tuple[tuple[float, float], list[str]]:
    if model.validity.velocity is not None:
        low, high = model.validity.velocity
        if low < 0.0 < high:
            return (low, high), []
        edge = max(abs(low), abs(high))
        return (-edge, edge), [f"the model was identified from {low:g} to {high:g} only; taken as valid to ±{edge:g}"]
    edge = 20.0 * (curves.stribeck_velocity or 0.05)
    return (-edge, edge), [f"the model states no range of velocity; compensation fades beyond ±{edge:g}"]


def _choose_source(curves: FrictionCurves, loop: LoopDynamics | None, unit: str) -> tuple[Source, list[str]]:
    fall, ratio = curves.steepest_fall, curves.static_ratio
    if loop is None:
        risky = ratio > _STICK_SLIP_RATIO and fall > 0.0
        why = f"static friction is {ratio:.1f} times Coulomb friction"
    else:
        risky = fall > loop.damping
        why = f"friction falls by {fall:.3g} {unit} and the loop damps with {loop.damping:.3g} {unit} only"
    if not risky:
        return "reference", []
    note = (
        f"{why}: following the reference alone would stick and slip, so the direction comes from the reference and "
        "the speed on the curve in part from the measured velocity; without one, half of the falling branch is used"
    )
    return "blend", [note]


def _choose_gain(model: FrictionModel, velocity_range: tuple[float, float]) -> tuple[float, list[str]]:
    gain = compute_confident_gain(model, velocity_range)
    if find_doubt(model) is not None:
        return _LOWEST_GAIN, [f"the model is not trusted; gain {_LOWEST_GAIN:g}"]
    if gain is None:
        return DEFAULT_GAIN, [f"the model has no covariance; gain {DEFAULT_GAIN:g}"]
    bounded = min(max(gain, _LOWEST_GAIN), _HIGHEST_GAIN)
    return bounded, [f"gain {bounded:.3f} from the lower 95 % bound of the friction"]
