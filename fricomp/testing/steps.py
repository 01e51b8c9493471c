"""The steps that tests of adapters are made of: open, start, run some cycles, look at the drives."""

from fricomp.errors import FricompError
from fricomp.joint import Capabilities, JointCommand, JointFeedback
from fricomp.testing.rig import AdapterRig

LONG = 0.5
"""Longer than any staleness limit or watchdog of a rig [s]."""


def n_joints(rig: AdapterRig) -> int:
    """Number of joints."""
    return len(rig.energised())


def opened(rig: AdapterRig) -> Capabilities:
    """Open the adapter."""
    return rig.adapter.open()


def start(rig: AdapterRig) -> None:
    """Configure for torque, and enable; the first command comes a period later, when the ramp is over."""
    rig.adapter.configure("torque", rig.period)
    rig.adapter.enable()
    rig.clock.advance(rig.period)


def cycle(rig: AdapterRig, torque: list[float], feedback: JointFeedback | None = None) -> bool:
    """One control cycle; whether the command was sent."""
    command = JointCommand(n_joints(rig))
    command.torque[:] = torque
    sent = rig.adapter.write(command)
    rig.clock.advance(rig.period)
    rig.adapter.read_into(feedback if feedback is not None else JointFeedback(n_joints(rig)))
    return sent


def run(rig: AdapterRig, cycles: int, feedback: JointFeedback | None = None, torque: float = 0.0) -> bool:
    """Some control cycles with the same torque on all joints; whether all were sent."""
    sent = [cycle(rig, [torque] * n_joints(rig), feedback) for _ in range(cycles)]
    return all(sent)


def with_errors_of_ours(rig: AdapterRig) -> None:
    """Go on for long enough that any fault must have been noticed; no error but the library's own may come."""
    try:
        for _ in range(round(LONG / rig.period)):
            if not cycle(rig, [0.5 * rig.torque_limit] * n_joints(rig)):
                break
    except FricompError:
        pass
    rig.clock.advance(rig.period)


def effective_torque(rig: AdapterRig) -> list[float]:
    """What the drives exert: nothing where they are not energised."""
    return [torque if on else 0.0 for torque, on in zip(rig.applied_torque(), rig.energised(), strict=True)]


def stopped(rig: AdapterRig) -> bool:
    """Whether no drive exerts torque."""
    return not any(abs(torque) > 1e-9 for torque in effective_torque(rig))


def within_limits(rig: AdapterRig) -> bool:
    """Whether no drive exerts more than the limit."""
    quanta = [joint.torque_quantum for joint in rig.adapter.capabilities.joints]
    return all(
        abs(torque) <= rig.torque_limit + quantum + 1e-6
        for torque, quantum in zip(effective_torque(rig), quanta, strict=True)
    )


def flattened(sent: list[object]) -> list[object]:
    """All that was sent: single frames, and bytes as they were handed over."""
    flat: list[object] = []
    for traffic in sent:
        flat.extend(traffic if isinstance(traffic, list) else [traffic])
    return flat
