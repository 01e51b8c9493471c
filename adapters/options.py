"""How an adapter is run, whatever the bus."""

from dataclasses import dataclass

from fricomp.control import JointLimits

from .transmission import Transmission


@dataclass(frozen=True)
class AdapterOptions:
    """What every adapter takes.

    Attributes:
        limits: One for each joint; nothing beyond them reaches a drive.
        transmissions: Motor to joint, one for each joint; None where the drive reports the joint side already.
        ramp_time: Time over which torque may rise to its limit after enabling [s].
        stale_after: Age at which feedback counts as lost [s].
        allow_no_watchdog: Enable a drive that would keep its last torque if the bus fell silent.
    """

    limits: tuple[JointLimits, ...]
    transmissions: tuple[Transmission, ...] | None = None
    ramp_time: float = 0.2
    stale_after: float = 0.02
    allow_no_watchdog: bool = False

    @property
    def gears(self) -> tuple[Transmission, ...]:
        """The transmission of each joint, one that changes nothing where none is given."""
        return tuple(self.transmissions or (Transmission(),) * len(self.limits))
