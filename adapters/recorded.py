"""What a recording of a joint says of it: facts that its adapter knows."""

from fricomp.recording import RecordingMetadata

from .adapter import JointAdapter


def recording_metadata(adapter: JointAdapter, joint: int, source: str) -> RecordingMetadata:
    """Facts for the recording of one joint.

    Args:
        adapter: Open.
        joint: Number of the joint.
        source: What has recorded it.

    Raises:
        AdapterError: The adapter is not open.
    """
    declared, limits = adapter.capabilities.joints[joint], adapter.options.limits[joint]
    return RecordingMetadata(
        joint=declared.name,
        motion=declared.motion,
        torque_unit=declared.torque_unit,
        torque_kind=declared.torque_kind,
        encoder_resolution=declared.position_quantum or None,
        position_limits=limits.position or declared.position_limits,
        velocity_limit=limits.velocity,
        continuous=limits.position is None and declared.position_limits is None,
        source=source,
        extra={
            "torque_limit": min(limits.torque, declared.torque_limit),
            "torque_quantum": declared.torque_quantum,
        },
    )
