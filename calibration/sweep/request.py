"""What a calibration was asked to be: stored with the run, so that a resumed one is the same."""

from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from fricomp.errors import ParameterError

from .analysis.analysis import parse_load
from .estimate import IdentificationSettings
from .planning.settings import SweepSettings


@dataclass(frozen=True)
class CalibrationOptions:
    """What is made of a sweep.

    Attributes:
        identification: How friction is identified.
        normal_load: `none`, `transmitted` or a number; a sweep records no column of it.
        gravity_unknown: Whether friction is the half difference of both directions.
        adaptive: Choose the speeds after the first pass for information.
        accuracy: Mean relative standard deviation at which an adaptive sweep stops [1].

    Raises:
        ParameterError: A value is outside its range, or two of them exclude each other.
    """

    identification: IdentificationSettings = field(default_factory=IdentificationSettings)
    normal_load: str = "none"
    gravity_unknown: bool = False
    adaptive: bool = False
    accuracy: float = 0.005

    def __post_init__(self) -> None:
        if self.normal_load == "column":
            raise ParameterError("a sweep records no normal_load column: use none, transmitted or a number")
        if self.normal_load not in ("none", "transmitted"):
            parse_load(self.normal_load)
        if self.gravity_unknown and self.normal_load == "transmitted":
            raise ParameterError("the transmitted load comes from a model, and gravity was said to be unknown")
        if self.gravity_unknown and self.adaptive:
            raise ParameterError("an adaptive sweep needs the gravity torque: give a model, or leave out --adaptive")
        if not (self.accuracy > 0.0 and isfinite(self.accuracy)):
            raise ParameterError(f"accuracy must be positive and finite, got {100.0 * self.accuracy:g} %")


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
        motion: File of the motion that is recorded instead of a sweep; empty for a sweep.
    """

    backend: str
    configuration: dict[str, Any] = field(default_factory=dict)
    joint: str = ""
    model: str = ""
    settings: SweepSettings = field(default_factory=SweepSettings)
    options: CalibrationOptions = field(default_factory=CalibrationOptions)
    motion: str = ""
