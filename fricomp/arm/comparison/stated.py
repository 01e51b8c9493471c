"""What a simulation states of friction and rotors, to be compared with what is found."""

from __future__ import annotations

from ..rigid.simulated_arm import SimulatedArm


def list_stated(arm: SimulatedArm, joint: int) -> dict[str, float]:
    """Numbers of a joint that the file states, in the units of a record: those that are not zero.

    Args:
        arm: The simulation.
        joint: Number of the joint.
    """
    coulomb, viscous = arm.friction[joint].tolist()
    stated = {"coulomb": coulomb, "viscous": viscous, "rotor_inertia": float(arm.armature[joint])}
    return {name: value for name, value in stated.items() if value > 0.0}
