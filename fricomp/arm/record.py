"""What is said of an arm: the record that `arm.json` holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import msgspec

from fricomp.diagnosis.record.result import Quantity
from fricomp.errors import DiagnosisError
from fricomp.untrusted import parse_json, read_whole
from fricomp.whole_file import whole_file

__all__ = [
    "ARM_SCHEMA",
    "ArmRecord",
    "FileErrors",
    "JointEffect",
    "JointFrame",
    "JointRecord",
    "LinkRecord",
    "PositionErrors",
    "arm_json_schema",
    "load_arm_record",
    "save_arm_record",
]

ARM_SCHEMA = "fricomp.arm/1"

LinkState = Literal["as_simulated", "off", "not_determined"]


class JointEffect(msgspec.Struct, frozen=True, kw_only=True):
    """Physics that the simulation leaves out in one joint.

    Attributes:
        name: Name in the catalogue.
        parameters: Its numbers.
        recurrence: Share of the halves of the recording that ask for it, from 0 to 1.
        log_bayes_factor: By how much it makes the recording more probable.
        fall: Part by which the joint's held-out error falls with it.
        equation: Its equation.
        indistinguishable_from: Other names that explain this recording as well.
        links_instead: Links that would explain it as well without the effect, were they far off the simulation.
    """

    name: str
    parameters: dict[str, Quantity]
    recurrence: float
    log_bayes_factor: float
    fall: float
    equation: str
    indistinguishable_from: tuple[str, ...] = ()
    links_instead: tuple[str, ...] = ()


class PositionErrors(msgspec.Struct, frozen=True, kw_only=True):
    """Open-loop motion of the whole arm from measured states, driven by the recorded torques, on held-out data.

    Attributes:
        after: Time from the start [s].
        simulation: Median error of the simulation with Coulomb, viscous and constant torques.
        files: That of `arm.xml` with `friction.json`.
        travel: Median of the way that the joint itself went.
        unit: `rad` or `m`.
    """

    after: float
    simulation: float
    files: float
    travel: float
    unit: str


class FileErrors(msgspec.Struct, frozen=True, kw_only=True):
    """What the written files are worth, made without the blocks that they are measured on.

    Attributes:
        torque_simulation: RMS error of the simulation with Coulomb, viscous and constant torques, in motion.
        torque_fit: That of the fit, on the same blocks.
        torque: That of `arm.xml` with `friction.json`.
        band: Upper end of the band in which torques are compared [Hz].
        positions: Errors of open-loop motion.
        best_gain: Factor on the friction of `friction.json` that would have left least of the torques, beside the load
            of `arm.xml`: what a compensator could have taken. None where the file has no friction.
    """

    torque_simulation: float
    torque_fit: float
    torque: float
    band: float
    positions: tuple[PositionErrors, ...] = ()
    best_gain: Quantity | None = None


class JointRecord(msgspec.Struct, frozen=True, kw_only=True):
    """One joint.

    Attributes:
        name: Of the joint.
        unit: Of its torques and errors.
        friction: Parameters of its friction beside what is in `effects`.
        effects: What the simulation leaves out, strongest first.
        rotor_inertia: Behind the gear, seen from the joint.
        error_simulation: Held-out RMS error of the simulation's inverse dynamics, Coulomb and viscous friction fitted.
        error_plain: The same with links and rotors fitted as well.
        error_model: Of the whole model.
        unexplained: What the whole model leaves that lasts from one mean of 0.2 s to the next, as no noise does, as
            part of the friction of the joint.
        files: Errors of the written files; None where the recording is too short for them.
        stiffness: Of its gear, where the motor's position was recorded and the gear gives way.
        creep_velocity: Speed below which its friction is viscous and holds nothing, as that of a simulator; None where
            it sticks [rad/s] or [m/s].
        possible_spring: Stiffness of a spring that is not named and explains the recording as well as links that weigh
            what is said of them; None where the recording speaks against one.
        link_change: What the links as found change of the joint's torque beside those of the simulation, as part of
            that torque; both RMS over the recording.
        stated: What the simulation states of "coulomb", "viscous" and "rotor_inertia", where that is not zero.
        unnamed: Effects that its model and its files hold and that are not named, with the part by which each lowers
            the joint's held-out error: the recording asks for them, and it is little, or not surely them.
        link_delay: By how much later than the torques of all what the links ask of this joint was recorded, where its
            friction contradicts that and nothing that is named explains it; None where there is no such time.
    """

    name: str
    unit: str
    friction: dict[str, Quantity]
    effects: tuple[JointEffect, ...]
    rotor_inertia: Quantity
    error_simulation: float
    error_plain: float
    error_model: float
    unexplained: float = 0.0
    files: FileErrors | None = None
    stiffness: Quantity | None = None
    creep_velocity: float | None = None
    possible_spring: Quantity | None = None
    link_change: float = 0.0
    stated: dict[str, float] = {}
    unnamed: dict[str, float] = {}
    link_delay: Quantity | None = None


class LinkRecord(msgspec.Struct, frozen=True, kw_only=True):
    """One link.

    Attributes:
        name: Of the link.
        simulated_mass: In the simulation [kg].
        mass: As the recording has it, the simulation being trusted where the recording says little.
        first_moment: Mass times place of its centre, in the frame of the link: x, y, z.
        state: Whether it is as simulated, off, or not determined by this motion.
        determined: Which of "mass", "x", "y", "z" this motion determines: the recording at least halves what was
            uncertain before. The others are mostly what the simulation has.
        simulated_first_moment: In the simulation [kg·m].
        instead: Links that would explain the recording as well, were they far off and this one not.
    """

    name: str
    simulated_mass: float
    mass: Quantity
    first_moment: dict[str, Quantity]
    state: LinkState
    determined: tuple[str, ...] = ()
    simulated_first_moment: dict[str, float] = {}
    instead: tuple[str, ...] = ()


class LoneLink(msgspec.Struct, frozen=True, kw_only=True):
    """A link that alone is heavier or lighter than simulated, by one factor on all of its mass.

    Attributes:
        name: Of the link.
        factor: Its mass over the simulated one.
        alike: Other links that would do as well, each by a factor of its own.
    """

    name: str
    factor: Quantity
    alike: tuple[str, ...] = ()


class JointFrame(msgspec.Struct, frozen=True, kw_only=True):
    """A frame in which the simulation would explain a joint that it hardly explains as it was recorded.

    Attributes:
        joint: Its name.
        direction: 1, or -1 where position and torque would count the other way.
        offset: What would be added to its position after that [rad] or [m].
    """

    joint: str
    direction: int
    offset: float


class ArmRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The content of `arm.json`.

    Attributes:
        schema: "fricomp.arm/1".
        sentences: The answer in plain words, most important first.
        joints: Each joint.
        links: Each link.
        delay: By which all torques are later than the positions.
        tilt: How far gravity leans over along the level axes of the simulation, by their names, as it does where the
            base is not level; None where nothing asks for it. arm.xml has it in its gravity.
        gravity: What the torques ask for in the axes of the simulation [m/s²], where the arm is mounted otherwise than
            there, or zero where gravity was taken off the torques; None where the file's is right. arm.xml has it.
        gain: Factor that all torques were measured with; None where nothing asks for one.
        cutoff: Highest frequency that was compared [Hz].
        duration: Time that was used [s].
        left_out: Part of the recording's time that was not used: gaps, and stretches too short between them.
        period: Between two rows of the recording [s].
        summary: The answer in a few sentences: what is wrong, in which joints and links, and what to do.
        held_joints: Joints of the simulation that nothing was recorded of.
        still_joints: Joints that were recorded and stood still: their links count as one with that which carries them.
        unknown_joints: Joints that were recorded and moved, and that the simulation does not have: they were left out.
        in_order: Whether the log has numbers where the simulation has names: they were taken in the order of its chain.
        turned_torques: Joints whose torques were recorded with the opposite sign, and were turned round.
        degrees: Whether positions were degrees, though nothing in the log said so.
        unwrapped: Joints whose positions wrapped round at a turn, and were taken to go on there.
        better_frames: Joints whose zero or direction seems to be another one than in the simulation.
        frames_instead: Zeros and directions of joints that would explain as much as another `gravity`.
        torque_scales: Factor on what the links of a joint ask for, by its name, where its torque seems to have another
            unit, such as that of its motor.
        one_way: Joints that hardly went back, whose friction is not told from a constant torque.
        lone_link: The link that alone is off, by one factor; None where no such does better than all links as found.
        guided: From when to when something else than the drives moved or held the arm [s, from the start]: these
            stretches were left out.
    """

    schema: str
    sentences: tuple[str, ...]
    joints: tuple[JointRecord, ...]
    links: tuple[LinkRecord, ...]
    delay: Quantity
    gain: Quantity | None
    cutoff: float
    duration: float
    left_out: float
    period: float = 0.0
    summary: tuple[str, ...] = ()
    held_joints: tuple[str, ...] = ()
    still_joints: tuple[str, ...] = ()
    unknown_joints: tuple[str, ...] = ()
    tilt: dict[str, Quantity] | None = None
    gravity: tuple[float, float, float] | None = None
    one_way: tuple[str, ...] = ()
    turned_torques: tuple[str, ...] = ()
    degrees: bool = False
    unwrapped: tuple[str, ...] = ()
    better_frames: tuple[JointFrame, ...] = ()
    frames_instead: tuple[JointFrame, ...] = ()
    torque_scales: dict[str, float] = {}
    guided: tuple[tuple[float, float], ...] = ()
    lone_link: LoneLink | None = None
    in_order: bool = False


def arm_json_schema() -> dict[str, Any]:
    """JSON schema of `arm.json`, as docs/arm.schema.json publishes it."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **msgspec.json.schema(ArmRecord)}


def save_arm_record(record: ArmRecord, path: Path) -> None:
    """Write `arm.json`, whole or not at all."""
    with whole_file(path, DiagnosisError) as part:
        part.write_bytes(msgspec.json.format(msgspec.json.encode(record), indent=2) + b"\n")


def load_arm_record(path: Path) -> ArmRecord:
    """Read `arm.json`.

    Raises:
        DiagnosisError: The file cannot be read, or is no record of an arm.
    """
    try:
        record = parse_json(read_whole(path), ArmRecord)
    except (OSError, msgspec.DecodeError) as error:
        raise DiagnosisError(f"cannot read {path} as the record of an arm: {error}") from error
    if record.schema != ARM_SCHEMA:
        raise DiagnosisError(f"{path} has the schema {record.schema!r}; this version reads {ARM_SCHEMA!r}")
    return record
