"""Whether joints that a log has by their numbers alone are those of the chain in its order, by what they show."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from fricomp.errors import SimulationFileError

from ..arm_recording import ArmRecording
from ..rigid.simulated_arm import SimulatedArm
from .frames import explains_better, measure_frames


def require_order(arm: SimulatedArm, recording: ArmRecording) -> None:
    """Refuse an order of joints that another one explains much better: two neighbours the other way round, or all.

    Args:
        arm: The simulation.
        recording: Of its joints, as far as their numbers tell.

    Raises:
        SimulationFileError: Another order does; the message has the line to write.
    """
    as_numbered = measure_frames(arm, recording)
    orders = list(_list_orders(len(arm.joints)))
    left = [measure_frames(arm, _reorder(recording, order)) for order in orders]
    best = min(range(len(orders)), key=left.__getitem__)
    if explains_better(left[best], as_numbered):
        names = ", ".join(arm.joints[j] for j in orders[best])
        raise SimulationFileError(
            f"joints of the log have numbers alone, and the torques are not those of {', '.join(arm.joints)} in this "
            f"order: {names} explains them much better. Say which is which by --match NAME_IN_LOG=JOINT for each joint"
        )


def _list_orders(count: int) -> Iterator[list[int]]:
    """Which column is that of each joint, in other orders than the given one."""
    for j in range(count - 1):
        yield [*range(j), j + 1, j, *range(j + 2, count)]
    if count > 2:
        yield list(range(count))[::-1]


def _reorder(recording: ArmRecording, order: Sequence[int]) -> ArmRecording:
    columns = list(order)
    parts = (replace(one, position=one.position[:, columns], torque=one.torque[:, columns]) for one in recording.parts)
    return replace(recording, parts=tuple(parts))
