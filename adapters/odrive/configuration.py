"""What a configuration file says about ODrives."""

from typing import Literal

from ..configuration import CanAdapterConfiguration, JointConfiguration


class OdriveJointConfiguration(JointConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One axis; `id` is its node.

    Attributes:
        torque_constant: [N·m/A]; needed on firmware 0.5, which reports current instead of torque.
    """

    torque_constant: float | None = None


class OdriveConfiguration(CanAdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """ODrives on one CAN bus.

    Attributes:
        firmware: Generation of the firmware.
        endpoints: Path of the `flat_endpoints.json` of exactly this firmware (0.6 only), through which watchdog,
            control mode and the drive's own torque limit are written and read back. Without it none of them can be
            confirmed, and there is torque mode only: nothing would bound the torque of the drive's own loop.
    """

    joints: tuple[OdriveJointConfiguration, ...]
    firmware: Literal["0.6", "0.5"] = "0.6"
    endpoints: str | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for joint in self.joints:
            if not 0 <= joint.id <= 62:
                raise ValueError(f"joint {joint.name!r}: nodes run from 0 to 62, got {joint.id}")
            if self.firmware == "0.5" and not (joint.torque_constant or 0.0) > 0.0:
                raise ValueError(
                    f"joint {joint.name!r}: firmware 0.5 reports current, so torque_constant [N·m/A] is needed"
                )
        if self.firmware == "0.5" and self.endpoints is not None:
            raise ValueError("endpoints over CAN exist from firmware 0.6 on")

    @property
    def minor(self) -> int:
        """5 or 6."""
        return int(self.firmware.partition(".")[2])
