"""What a configuration file says about CiA 402 drives."""

from math import inf

from ..configuration import CanAdapterConfiguration, JointConfiguration


class CanOpenJointConfiguration(JointConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One drive; `id` is its node.

    Attributes:
        counts_per_revolution: Position counts a motor turn; read from the drive (6092 and 6091, or 608F) if not given.
        velocity_count: One count of velocity at the motor [rad/s]; read from the drive (60A9) if not given.
    """

    counts_per_revolution: float | None = None
    velocity_count: float | None = None

    def __post_init__(self) -> None:
        for name in ("counts_per_revolution", "velocity_count"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < inf:
                raise ValueError(f"{name} must be finite and above 0, got {value!r}: a reversal belongs into sign")


class CanOpenConfiguration(CanAdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """CiA 402 drives on one CAN bus.

    Attributes:
        master_id: Node number under which our heartbeat goes out; the drives watch it.
        heartbeat: Period of the drives' own heartbeats [s].
        abort_option: Object 6007, what a drive does when our heartbeat fails: 1 fault, 2 disable voltage, 3 quick stop.
    """

    joints: tuple[CanOpenJointConfiguration, ...]
    master_id: int = 127
    heartbeat: float = 0.05
    abort_option: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        taken = [joint.id for joint in self.joints]
        if not all(1 <= node <= 127 for node in [*taken, self.master_id]):
            raise ValueError(f"node numbers run from 1 to 127, got {[*taken, self.master_id]}")
        if self.master_id in taken:
            raise ValueError(f"master_id {self.master_id} is the node of a joint, too")
        if self.abort_option not in (1, 2, 3):
            raise ValueError(f"abort_option must be 1, 2 or 3, got {self.abort_option}: 0 would keep the torque")
        if not 0.005 <= self.heartbeat <= 1.0:
            raise ValueError(f"heartbeat must be from 0.005 to 1 s, got {self.heartbeat}")

    @property
    def beat_period(self) -> float:
        """Period of our own heartbeat [s], four of which fit into the drives' watchdog."""
        return self.watchdog / 4.0
