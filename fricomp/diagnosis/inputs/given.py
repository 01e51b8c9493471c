"""What a diagnosis is given, checked and brought to the side of the joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fricomp.errors import DiagnosisError
from fricomp.model import FrictionModel
from fricomp.recording import Recording
from fricomp.recording.named.sliding import take_motion
from fricomp.recording.parts.parts import UsableParts

from .checks import kind_against, name_parts, remarks_on, take_usable
from .controller import Controller, estimate_controller
from .controller_check import check_controller
from .past import Past
from .rigid import RigidJoint, read_simulation


@dataclass(frozen=True)
class Given:
    """What a diagnosis starts from.

    Attributes:
        recordings: Of one joint, on its own side.
        names: What each recording is called.
        rigid: The simulation's joint, where its inertia is in the unit of the recorded torque; else None.
        friction: Friction model that is compared; None where none was given.
        loops: The loop that moved the joint in each recording; None where it is not known.
        remarks: What the checks noticed and dealt with, in sentences.
        reasons: Why these data cannot be diagnosed, in sentences; empty where they can.
        data: What is usable of each recording that was given.
        pasts: How the joint was driven over what each is a stretch of; None where it is all of it.
        whole: All that is usable, of recordings that are longer than what is searched; empty where all is searched.
    """

    recordings: tuple[Recording, ...]
    names: tuple[str, ...]
    rigid: RigidJoint | None = None
    friction: FrictionModel | None = None
    loops: tuple[Controller | None, ...] = ()
    remarks: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    data: tuple[UsableParts, ...] = ()
    pasts: tuple[Past | None, ...] = ()
    whole: tuple[Recording, ...] = ()


def read_given(
    recordings: Sequence[Recording],
    simulation: RigidJoint | str | Path | None,
    *,
    joint: str | None = None,
    friction: FrictionModel | None = None,
    controller: Controller | None = None,
    names: Sequence[str] | None = None,
    simulation_error: float | None = None,
) -> Given:
    """Read the simulation and check the recordings.

    Args:
        recordings: Of one joint.
        simulation: MJCF or URDF file, or the joint that was read from one; None where there is none.
        joint: Name of the joint; None where there is only one.
        friction: Friction model that is compared.
        controller: The loop that moved the joint; None to estimate it.
        names: What each recording is called; None to count them.
        simulation_error: Relative standard deviation by which inertia and gravity of the simulation may be off; None
            for the usual one.

    Raises:
        DiagnosisError: The simulation cannot be read, or its error is not positive.
    """
    called = tuple(names or (f"recording {i + 1}" for i in range(len(recordings))))
    rigid = read_simulation(simulation, joint) if isinstance(simulation, str | Path) else simulation
    if simulation_error is not None and not simulation_error > 0.0:
        raise DiagnosisError(f"simulation_error is {simulation_error:g}; give a positive share, such as 0.2 for 20 %")
    if rigid is not None and simulation_error is not None:
        rigid = replace(rigid, error=simulation_error)
    logged = recordings
    if rigid is not None:
        recordings = [take_motion(one, rotary=rigid.rotary) for one in recordings]
    usable = take_usable(recordings, joint)
    reasons = [*usable.reasons, *(kind_against(recordings, rigid.rotary) if rigid else ())]
    if reasons:
        return Given(tuple(recordings), called, reasons=tuple(reasons), data=usable.data)
    whole = usable.whole or tuple(usable.recordings)
    remarks = [*remarks_on(whole, name_parts(whole, called)), *usable.remarks]
    if any(one is not other for one, other in zip(recordings, logged, strict=True)):
        remarks.append("The simulation's joint slides, and the log states no unit: it was taken to be in m and N.")
    called = name_parts(usable.recordings, called)
    turned = tuple(one.on_joint_side() for one in usable.recordings)
    remarks += [] if controller is None else check_controller(controller, turned)
    # Inertia is compared only where it is in the unit of the recorded torque.
    comparable = all(one.metadata.torque_unit in ("N·m", "N") for one in turned)
    if rigid is not None and not comparable:
        remarks.append(
            f"Careful: the torque is in {turned[0].metadata.torque_unit}: inertia, gravity and any spring of the "
            "simulation were not compared, they are fitted; with a torque in N·m or N they are."
        )
    return Given(
        recordings=turned,
        names=called,
        rigid=rigid if comparable else None,
        friction=friction,
        loops=tuple(estimate_controller(one) if controller is None else controller for one in turned),
        remarks=tuple(remarks),
        data=usable.data,
        pasts=usable.pasts,
        whole=tuple(one.on_joint_side() for one in usable.whole),
    )
