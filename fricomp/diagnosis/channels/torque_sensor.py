"""The motor's torque beside that of a sensor: its gain, and how far it saturates."""

from __future__ import annotations

from fricomp.recording import Recording
from fricomp.recording.checks.torque_sensor import TwoTorques, fit_two_torques

from ..effects import EFFECTS
from ..record.result import NamedEffect, Quantity


def compare_torques(recording: Recording) -> tuple[NamedEffect, ...]:
    """What the sensor says of the motor's torque; nothing where both agree, or where there is no sensor."""
    fit = fit_two_torques(recording)
    if fit is None:
        return ()
    found = [_describe_saturation(fit, recording.metadata.torque_unit)] if fit.saturates else []
    if fit.is_off:
        found.append(_describe_gain(*fit.told_gain, small=fit.saturates))
    return tuple(found)


def _describe_saturation(fit: TwoTorques, unit: str) -> NamedEffect:
    effect = EFFECTS["torque_saturation"]
    size, half = -fit.bend / fit.small_gain, 1.96 * fit.bend_deviation / fit.small_gain
    return NamedEffect(
        name=effect.name,
        kind=effect.kind,
        parameters={"coefficient": Quantity(size, f"1/({unit})²", (size - half, size + half))},
        equation=effect.equation,
        sentence=f"{effect.says}, as the torque sensor shows: {100 * fit.loss:.0f} % less at {fit.largest:.3g} {unit}",
        citation=effect.citation,
    )


def _describe_gain(gain: float, deviation: float, *, small: bool) -> NamedEffect:
    effect = EFFECTS["torque_gain_error"]
    error, half = 1.0 / gain - 1.0, 1.96 * deviation / gain**2
    where = " at small torques" if small else ""
    return NamedEffect(
        name=effect.name,
        kind=effect.kind,
        parameters={"gain_error": Quantity(error, "1", (error - half, error + half))},
        equation=effect.equation,
        sentence=f"{effect.says}: the torque sensor reads {gain:.4g} times it{where}",
        citation=effect.citation,
    )
