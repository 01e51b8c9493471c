"""A whole arm: torque error of each joint, and open-loop motion of all joints together."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fricomp.errors import RecordingError
from fricomp.model import FrictionModel, load_model
from fricomp.overview import Overview, OverviewTable, Shown
from fricomp.recording import Recording

from .arm_motion import ArmMotion, read_arm_motion
from .errors import Spans, compare_joints, measure_torque, select_starts, summarise_positions
from .reading import Source
from .result import PositionError, TorqueError
from .settings import EVALUATION, HORIZONS
from .simulated_arm import SimulatedArm, read_simulated_arm


@dataclass(frozen=True)
class JointErrors:
    """Errors of one joint of an arm.

    Attributes:
        name: Of the joint.
        torque: Along the recorded motion.
        position: Of open-loop simulations of the whole arm, by their length.
    """

    name: str
    torque: TorqueError
    position: tuple[PositionError, ...]


@dataclass(frozen=True, repr=False)
class ArmEvaluation(Shown):
    """How well the files of an arm predict its recordings.

    Attributes:
        model: What was evaluated, in words.
        joints: Errors of each joint.
        notes: What to know about the figures, in sentences.
    """

    model: str
    joints: tuple[JointErrors, ...]
    notes: tuple[str, ...] = ()

    def joint(self, name: str) -> JointErrors:
        """Errors of one joint.

        Raises:
            KeyError: There is none of that name.
        """
        return {one.name: one for one in self.joints}[name]

    def to_json(self) -> dict[str, Any]:
        """All figures as JSON values."""
        return asdict(self)

    def headline(self) -> str:
        """Torque error of each joint."""
        return f"of {self.model}: " + ", ".join(
            f"{one.name} {one.torque.rms:.3g} {one.torque.unit}" for one in self.joints
        )

    def overview(self) -> Overview:
        """A table, a joint a row."""
        times = [one.after for one in self.joints[0].position]
        heads = ("joint", "torque error, RMS", "median", *(f"position error after {time:g} s" for time in times))
        rows = tuple(
            (
                one.name,
                f"{one.torque.rms:.4g} {one.torque.unit}",
                f"{one.torque.median:.4g}",
                *(f"{each.median:.4g} {each.unit}" for each in one.position),
            )
            for one in self.joints
        )
        band = self.joints[0].torque.band
        sentences = (f"Torque errors in the band from 0 to {band:g} Hz, where a joint moves.", *self.notes)
        return Overview(f"Evaluation of {self.model}", sentences, (OverviewTable(heads, rows),))


def evaluate_arm(
    simulation: Source,
    recordings: Sequence[Recording],
    *,
    friction: Mapping[str, FrictionModel | Source] | None = None,
    match: Mapping[str, str] | None = None,
    spans: Spans | None = None,
    band: float | None = None,
    torque_delay: float | Mapping[str, float] = 0.0,
    positions: bool = True,
    longest: float = HORIZONS[-1],
) -> ArmEvaluation:
    """Measure the errors of an arm's files over recordings of all its joints, each figure as `evaluate` has it.

    Args:
        simulation: MJCF or URDF file of the arm. Without `friction` it is evaluated as it is, friction and all; drives
            of the file are switched off. Joints without a recording are held where the file has them.
        recordings: One of each joint, from the same time.
        friction: Friction model of each joint, by the name in the recordings; that of the file is then left out. A
            joint that is not among them has none.
        match: Name in the simulation by name in the recordings, where they differ.
        spans: Times that count [s]; all if None.
        band: Upper end of the band of the torque errors [Hz]; chosen if None.
        torque_delay: Time by which all recorded torques are late, or that of each joint by its name in the recordings
            [s].
        positions: Whether to simulate as well.
        longest: Of the open-loop simulations [s].

    Raises:
        RecordingError: The recordings share too little time, or are not in N·m or N.
        SimulationFileError: The file cannot be read, or has no such joint.
        ModelFileError: A friction model cannot be read.
    """
    series = [one.on_joint_side() for one in recordings]
    motion = read_arm_motion(series, band=band, torque_delay=torque_delay)
    names = [(match or {}).get(name, name) for name in motion.names]
    laws = None if friction is None else _read_laws(friction, motion.names)
    arm = read_simulated_arm(simulation, names, laws)
    return _measure(arm, motion, spans, Path(simulation).name, longest if positions else 0.0)


def _read_laws(
    friction: Mapping[str, FrictionModel | Source], names: Sequence[str]
) -> tuple[FrictionModel | None, ...]:
    unknown = sorted(set(friction) - set(names))
    if unknown:
        raise RecordingError(f"there is no recording of joint {unknown[0]!r}; there are {', '.join(names)}")
    models = (friction.get(name) for name in names)
    return tuple(one if one is None or isinstance(one, FrictionModel) else load_model(one) for one in models)


def _measure(arm: SimulatedArm, motion: ArmMotion, spans: Spans | None, name: str, longest: float) -> ArmEvaluation:
    along = [arm.follow(motion, number) for number in range(motion.n_parts)]
    torque = [
        measure_torque(one, [part.torque for part in one.parts], [each.torque[:, j] for each in along], spans)
        for j, one in enumerate(motion.joints)
    ]
    moves = [motion.moves(k) for k in range(motion.n_parts)]
    starts = select_starts(motion.times, moves, spans, EVALUATION.arm_starts, longest)
    found = compare_joints(
        motion.joints,
        starts,
        lambda number, chosen, lengths: arm.simulate(motion, number, along[number], chosen, lengths),
    )
    joints = tuple(
        JointErrors(name, error, summarise_positions(one, pairs))
        for name, error, one, pairs in zip(motion.names, torque, motion.joints, found, strict=True)
    )
    return ArmEvaluation(name if arm.laws is None else f"friction models in {name}", joints, arm.notes)
