"""Known effects put into real recordings: the noise, the friction and the flaws stay those of a real joint.

The torque that an effect would have cost along the *measured* motion is added to the recorded torque channel. Position
and time are left as they were recorded, so that the loop has not reacted to the effect; what proves itself here is
naming under real noise, not the closed loop, which the simulated cases have.

Strength is measured as on simulated cases: what a refit of a rigid joint with a Stribeck curve for each direction
leaves of the effect, in windows, over what the same refit leaves of the recording itself (noise and all that real
joints have beside).
"""

import hashlib
import json
import secrets
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording import Recording, read_public, write_recording
from fricomp.root_mean_square import compute_rms

from .cases import REAL_CASES
from .injected_effect import INJECTED, InjectedTorque, MeasuredMotion, measure_motion

Samples = NDArray[np.float64]

INJECTABLE = {
    "emps": ("cogging", "quadratic_drag", "position_coulomb", "torque_delay"),
    "laas-cogging": ("quadratic_drag", "torque_delay"),
    "ur10e-joint-1": ("cogging", "quadratic_drag", "position_coulomb"),
    "ur10e-joint-2": ("load_coulomb", "cogging", "quadratic_drag"),
    "franka-joint-7": ("cogging", "position_coulomb", "quadratic_drag"),
    "servo-large": ("quadratic_drag", "torque_delay"),
}
"""What can be seen in each set's motion: a load needs gravity, a delay fast changes, drag a wide range of speeds."""

_LONGEST = 60.0  # [s] of each recording that is used
_KEPT = ("time", "position", "torque", "velocity", "load_torque", "temperature", "position_reference")
_STRENGTH = {"1": 1.0, "2": 2.0, "5": 5.0}


@dataclass(frozen=True)
class InjectedSpec:
    """A real recording and what is put into it.

    Attributes:
        source: Name of a case of `REAL_CASES`.
        effect: One of `INJECTED`; empty to leave the recording as it is.
        strength: 1, 2 or 5: what survives a refit of the base over what that refit leaves of the recording.
        seed: Draws order, phase and sign.
        known: What the diagnosis says of the recording as it is: those names are no false ones.
        base: Its verdict there.
    """

    source: str
    effect: str = ""
    strength: str = ""
    seed: int = 0
    known: tuple[str, ...] = ()
    base: str = ""

    def __post_init__(self) -> None:
        for what, value, valid in (
            ("recording", self.source, tuple(INJECTABLE)),
            ("effect", self.effect, ("", *INJECTED)),
            ("strength", self.strength, ("", *_STRENGTH)),
        ):
            if value not in valid:
                raise RecordingError(f"unknown {what} {value!r}: valid are {', '.join(filter(None, valid))}")

    @property
    def name(self) -> str:
        """A name that says nothing about what is concealed."""
        return "case-" + hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:12]


class Injected(NamedTuple):
    """A case made from a real recording.

    Attributes:
        files: What the diagnosis may read, by file name.
        answer: What it may not, as JSON.
    """

    files: dict[str, bytes]
    answer: bytes


def inject(spec: InjectedSpec, salt: str | None = None) -> Injected:
    """Make the case and its answer.

    Raises:
        RecordingError: The data are not here, or nothing of the effect would survive a refit of the base.
    """
    case = next(case for case in REAL_CASES if case.name == spec.source)
    recordings = [_trimmed(one) for source in case.sources for one in read_public(source)]
    span = float(np.ptp(np.concatenate([one.position for one in recordings])))
    motions = [measure_motion(one.time, one.position, one.torque, span) for one in recordings]
    found = _scaled(spec, motions) if spec.effect else _Found([np.zeros(len(one)) for one in recordings], {}, 0.0)
    changed = [
        Recording.from_channels({**one.channels, "torque": one.torque + extra}, one.metadata)
        for one, extra in zip(recordings, found.torque, strict=True)
    ]
    answer = _answer(spec, found, sum(one.duration for one in recordings), motions)
    answer["salt"] = salt or secrets.token_hex(16)
    return Injected(_files(changed), (json.dumps(answer, indent=1, ensure_ascii=False) + "\n").encode())


class _Found(NamedTuple):
    """Torque to add to each recording, the true parameters, and the strength reached."""

    torque: list[Samples]
    parameters: dict[str, tuple[float, str]]
    enr: float


def _trimmed(recording: Recording) -> Recording:
    """The first minute, without channels in which the effect would not show."""
    part = recording.window(recording.time[0], recording.time[0] + _LONGEST)
    return Recording.from_channels({name: v for name, v in part.channels.items() if name in _KEPT}, part.metadata)


def _scaled(spec: InjectedSpec, motions: list[MeasuredMotion]) -> _Found:
    """The amplitude at which the wanted share of the recording's own residual survives; most are linear in it."""
    build = INJECTED[spec.effect].build
    noise = compute_rms(np.concatenate([motion.left for motion in motions]))

    def at(amplitude: float) -> tuple[list[InjectedTorque], float]:
        made = [build(motion, amplitude, np.random.default_rng([spec.seed, 5])) for motion in motions]
        left = np.concatenate([motion.left_of(one.torque) for motion, one in zip(motions, made, strict=True)])
        return made, compute_rms(left) / noise

    amplitude, limit = INJECTED[spec.effect].unit, INJECTED[spec.effect].limit
    made, reached = at(amplitude)
    for _ in range(8):
        if reached <= 0.0:
            raise RecordingError(f"nothing of {spec.effect} survives a refit of the base in {spec.source}")
        amplitude = min(amplitude * _STRENGTH[spec.strength] / reached, limit)
        made, reached = at(amplitude)
        if abs(reached / _STRENGTH[spec.strength] - 1.0) < 0.02 or amplitude == limit:
            break
    return _Found([one.torque for one in made], made[0].parameters, reached)


def _files(recordings: list[Recording]) -> dict[str, bytes]:
    files = {}
    with TemporaryDirectory() as place:
        for number, recording in enumerate(recordings, start=1):
            path = Path(place) / f"recording{f'_{number}' if number > 1 else ''}.parquet"
            write_recording(recording, path)
            files[path.name] = path.read_bytes()
    return files


def _answer(spec: InjectedSpec, found: _Found, duration: float, motions: list[MeasuredMotion]) -> dict[str, Any]:
    """In the form that answers of simulated cases have."""
    effects = [_describe(spec, found)] if spec.effect else []
    verdict = {"physics": "missing_physics", "measurement": "measurement"}
    named = {"excitation": spec.source, "duration": duration}
    return {
        "schema": "fricomp.concealed/1",
        "id": spec.name,
        "spec": asdict(spec) | named,
        "verdict": verdict[INJECTED[spec.effect].kind] if spec.effect else spec.base or "consistent",
        "effects": effects,
        "shifted_parameters": list(spec.known),
        "enr": found.enr,
        "rows": sum(motion.left.size for motion in motions),
        "location": {"time": []},
        "joint": {"core": "recorded", "noise_kind": f"recorded, {spec.base}" if spec.base else "recorded"},
    }


def _describe(spec: InjectedSpec, found: _Found) -> dict[str, Any]:
    true = {name: {"value": value, "unit": unit} for name, (value, unit) in found.parameters.items()}
    return {
        "name": spec.effect,
        "kind": INJECTED[spec.effect].kind,
        "form": "along the measured motion",
        "shared_form": True,
        "enr": found.enr,
        "separable_enr": found.enr,
        "localised": False,
        "accepted": [],
        "parameters": true,
        "comparable": true,
    }
