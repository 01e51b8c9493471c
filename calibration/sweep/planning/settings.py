"""How a sweep is run: what a user may choose, with defaults that suit most joints."""

from dataclasses import dataclass
from math import isfinite
from typing import Literal

from fricomp.errors import ParameterError

from .speed import parse_speeds

LoopChoice = Literal["auto", "drive", "host"]


@dataclass(frozen=True)
class SweepSettings:
    """Everything about a sweep but the joint itself. It is stored with the run, so that a resumed one is the same.

    Attributes:
        speeds: As `parse_speeds` reads them; empty for log-spaced over what the travel allows.
        speed_count: Number of speeds where none are given.
        dense_count: Further speeds on the falling branch, placed once the first pass has shown where it is.
        repeats: How often each speed is visited in each direction.
        dwell: Time on a plateau after it has settled [s]; slow plateaus last until the encoder has counted enough.
        settle: Longest time to wait for a plateau to settle [s].
        ramp: Time to reach the plateau's speed [s].
        positions: Places over the travel at which slow plateaus are centred in turn, such as to vary the normal load.
        warm_up: Time of moving to and fro before the first plateau [s].
        breakaway_positions: Positions at which the static torque is measured; 0 for none.
        tare: Time at rest without torque, at the start and at the end, for the zero of the torque sensor [s].
        check_torque: Torque at which the sign check gives up, as a fraction of the torque limit [1].
        loop: Who closes the velocity loop: the `drive`, the `host`, or the drive where it can (`auto`).
        rate: Cycles of the loop [Hz]; 0 for 500 with the drive's loop and 1000 with the host's.
        inertia: About the joint, for the gains of the host's loop [kg·m²]; 0 to take it from the model.
        bandwidth: Of the host's loop [rad/s].
        seed: Of the order of the plateaus.

    Raises:
        ParameterError: A value is outside its range.
    """

    speeds: str = ""
    speed_count: int = 12
    dense_count: int = 8
    repeats: int = 2
    dwell: float = 1.0
    settle: float = 1.5
    ramp: float = 0.2
    positions: int = 1
    warm_up: float = 8.0
    breakaway_positions: int = 5
    tare: float = 5.0
    check_torque: float = 0.3
    loop: LoopChoice = "auto"
    rate: float = 0.0
    inertia: float = 0.0
    bandwidth: float = 60.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least in (
            ("speed_count", 4),
            ("dense_count", 0),
            ("repeats", 1),
            ("positions", 1),
            ("breakaway_positions", 0),
            ("seed", 0),
        ):
            if getattr(self, name) < least:
                raise ParameterError(f"{name} must be at least {least}, got {getattr(self, name)!r}")
        for name in ("dwell", "settle", "ramp", "bandwidth"):
            if not (getattr(self, name) > 0.0 and isfinite(getattr(self, name))):
                raise ParameterError(f"{name} must be positive and finite, got {getattr(self, name)!r}")
        for name in ("warm_up", "tare", "rate", "inertia"):
            if not (getattr(self, name) >= 0.0 and isfinite(getattr(self, name))):
                raise ParameterError(f"{name} must be finite and not negative, got {getattr(self, name)!r}")
        if not 0.0 < self.check_torque <= 1.0:
            raise ParameterError(f"check_torque is a fraction of the torque limit, got {self.check_torque!r}")
        if self.speeds:
            parse_speeds(self.speeds)
        if self.loop not in ("auto", "drive", "host"):
            raise ParameterError(f"loop must be auto, drive or host, got {self.loop!r}")
