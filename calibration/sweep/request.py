"""What a calibration was asked to be: stored with the run, so that a resumed one is the same."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .estimate import IdentificationSettings
from .settings import SweepSettings

__all__ = ["CalibrationOptions", "CalibrationRequest"]


@dataclass(frozen=True)
class CalibrationOptions:
    """What is made of a sweep.

    Attributes:
        identification: How friction is identified.
        normal_load: `none`, `transmitted`, `column` or a number.
        gravity_unknown: Whether friction is the half difference of both directions.
        adaptive: Choose the speeds after the first pass for information.
        accuracy: Mean relative standard deviation at which an adaptive sweep stops [1].
    """

    identification: IdentificationSettings = field(default_factory=IdentificationSettings)
    normal_load: str = "none"
    gravity_unknown: bool = False
    adaptive: bool = False
    accuracy: float = 0.005


@dataclass(frozen=True)
class CalibrationRequest:
    """Joint, sweep and identification.

    Attributes:
        backend: Name of the adapter.
        configuration: Of the adapter.
        joint: Name of the joint; empty for the first.
        model: MJCF file of the mechanism; empty where there is none.
        settings: Of the sweep.
        options: What is made of it.
    """

    backend: str
    configuration: dict[str, Any] = field(default_factory=dict)
    joint: str = ""
    model: str = ""
    settings: SweepSettings = field(default_factory=SweepSettings)
    options: CalibrationOptions = field(default_factory=CalibrationOptions)
