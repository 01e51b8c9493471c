"""What the loop saw, cycle by cycle, before it becomes a block of a recording."""

import numpy as np

from fricomp.errors import SweepAborted
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata


class CycleLog:
    """Samples of one joint, with the positions of all of them for the rigid-body model.

    Args:
        joint: Index of the joint under test.
    """

    def __init__(self, joint: int) -> None:
        self._joint = joint
        self.time_ns: list[int] = []
        self.position: list[float] = []
        self.velocity: list[float] = []
        self.torque: list[float] = []
        self.temperature: list[float] = []
        self.reference: list[float] = []
        self.command: list[float] = []
        self.all_positions: list[tuple[float, ...]] = []

    def __len__(self) -> int:
        return len(self.time_ns)

    def configuration(self) -> FloatArray:
        """Positions of all joints [rad] or [m]. Shape (n_samples, n_joints)."""
        return np.array(self.all_positions, dtype=np.float64)

    def to_recording(self, start_ns: int, metadata: RecordingMetadata, load_torque: FloatArray | None) -> Recording:
        """The samples as a recording; channels the drive does not report are left out.

        Args:
            start_ns: Time on the adapter's clock that counts as zero [ns].
            metadata: Of the run.
            load_torque: Rigid-body torque, shape (n_samples,) [N·m] or [N]; None where it is unknown.

        Raises:
            SweepAborted: The drive reported nothing.
        """
        if len(self) < 2:
            raise SweepAborted(f"joint {metadata.joint!r} reported {len(self)} samples: check the bus and its rate")
        channels: dict[str, FloatArray] = {
            "time": np.asarray((np.array(self.time_ns, dtype=np.int64) - start_ns) * 1e-9, dtype=np.float64),
            "position": np.array(self.position),
            "velocity": np.array(self.velocity),
            "torque": np.array(self.torque),
            "temperature": np.array(self.temperature),
            "velocity_reference": np.array(self.reference),
            "torque_command": np.array(self.command),
        }
        if load_torque is not None:
            channels["load_torque"] = load_torque
        kept = {name: v for name, v in channels.items() if name in ("position", "torque") or np.all(np.isfinite(v))}
        return Recording.from_channels(kept, metadata)
