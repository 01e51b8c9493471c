"""The files of a case: what the diagnosis may read, and in another folder what it must not."""

import hashlib
import json
import secrets
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.whole_file import whole_file, write_whole

from .belief import format_controller, format_friction, format_simulation
from .case import Case
from .catalogue_fit import fit_catalogue
from .dynamics import SAMPLE_PERIOD
from .fault import apply_fault
from .plant import CORES
from .refit import compute_enr, compute_left_after_refit
from .spec import CaseSpec
from .strength import Concealed

ANSWER_SCHEMA = "fricomp.concealed/1"
_VERDICTS = {
    "outside": "unknown_physics",
    "physics": "missing_physics",
    "measurement": "measurement",
    "parameter": "parameters",
}
_PARAMETERS = ("inertia_error", "payload_error")


def derive_case_id(spec: CaseSpec) -> str:
    """A name that says nothing about what is concealed."""
    return "case-" + hashlib.sha256(json.dumps(asdict(spec), sort_keys=True).encode()).hexdigest()[:12]


def choose_expected_verdict(case: Case) -> str:
    """The verdict of a right answer: that of the strongest kind."""
    if case.spec.fault:
        return "bad_data"
    kinds = [each.effect.kind for each in case.concealed]
    for kind in ("outside", "physics", "measurement", "parameter"):
        if kind in kinds:
            return _VERDICTS[kind]
    return "parameters" if case.spec.shifted else "consistent"


def write_case(case: Case, folder: Path) -> Path:
    """Write recording, simulation and controller, and the friction where the case is about its parameters.

    Of any other case every second one comes with the friction of the joint without effects: that must not be found
    changed.

    Returns:
        The case's folder, `folder`/<id>.
    """
    target = folder / derive_case_id(case.spec)
    fields = {**case.scene.joint.fields, **case.change.plant, **case.belief}
    _write_table(_collect_channels(case), _collect_metadata(case), target / "recording.parquet")
    write_whole(target / "joint.xml", format_simulation(fields, fields["limit"]))
    write_whole(target / "loop.toml", format_controller(fields))
    if any(each.effect.against == "nothing" for each in case.concealed) or _is_friction_stated(case):
        write_whole(target / "friction.json", format_friction(fields))
    return target


def write_answer(case: Case, folder: Path, salt: str | None = None) -> tuple[Path, str]:
    """Write the answer and the noise-free truth of a case.

    Returns:
        The answer's path, `folder`/<id>.json, and the SHA-256 of its bytes, which hold the salt.
    """
    name = derive_case_id(case.spec)
    truth = folder / f"{name}.parquet"
    _write_table(_collect_truth(case), {}, truth)
    answer = _build_answer(case) | {
        "truth_sha256": hashlib.sha256(truth.read_bytes()).hexdigest(),
        "salt": salt or secrets.token_hex(16),
    }
    data = (json.dumps(answer, indent=1, ensure_ascii=False) + "\n").encode()
    path = folder / f"{name}.json"
    write_whole(path, data)
    return path, hashlib.sha256(data).hexdigest()


def _collect_channels(case: Case) -> dict[str, NDArray[np.float64]]:
    sensed, start = case.outcome.sensed, case.start
    n = sensed.position.size
    rng = np.random.default_rng([case.spec.seed, 77])
    channels = {
        "time": _sample_time(n),
        "position": sensed.position,
        "torque": sensed.torque,
        "position_reference": case.scene.reference[start:, 0],
        "velocity_reference": case.scene.reference[start:, 1],
        "torque_command": case.outcome.motion.command,
        "current": sensed.torque / (0.1 * case.scene.joint.gear_ratio),
    }
    if _is_logged(case, "velocity_lag", rng):
        channels["velocity"] = sensed.velocity
    if not case.spec.hidden and (_is_logged(case, "load", rng)):
        channels["load_torque"] = sensed.load_torque
    if not case.spec.hidden and (case.change.temperature is not None or rng.random() < 0.5):
        channels["temperature"] = case.temperature + 0.05 * rng.standard_normal(n)
    return apply_fault(channels, case.spec.fault, rng) if case.spec.fault else channels


def _sample_time(n: int) -> NDArray[np.float64]:
    return np.asarray(SAMPLE_PERIOD * np.arange(n), dtype=np.float64)


def _is_friction_stated(case: Case) -> bool:
    return bool(np.random.default_rng([case.spec.seed, 78]).random() < 0.5)


def _is_logged(case: Case, about: str, rng: np.random.Generator) -> bool:
    """A channel is there where an effect needs it, and by chance where none does, so that it gives nothing away."""
    needed = any(name.startswith(about) for name in (*case.change.plant, *case.change.sensing))
    return bool(rng.random() < 0.5) or needed


def _collect_metadata(case: Case) -> dict[str, Any]:
    joint = case.scene.joint
    return {
        "schema": "fricomp.recording/1",
        "joint": "joint",
        "motion": "rotary",
        "torque_unit": "N·m",
        "torque_side": "joint",
        "torque_kind": "measured",
        "gear_ratio": joint.gear_ratio,
        "encoder_resolution": joint.fields["resolution"],
        "source": "concealed case",
    }


def _collect_truth(case: Case) -> dict[str, NDArray[np.float64]]:
    motion = case.outcome.motion
    alone = {f"concealed_{i}": each.torque for i, each in enumerate(case.concealed)}
    return {
        "time": _sample_time(motion.position.size),
        "concealed_torque": case.outcome.torque,
        "position": motion.position,
        "velocity": motion.velocity,
        "acceleration": motion.acceleration,
        "torque": case.outcome.sensed.torque - case.outcome.sensed.torque_error,
        **alone,
    }


def _build_answer(case: Case) -> dict[str, Any]:
    shifted = list(_PARAMETERS) if case.spec.shifted else []
    return {
        "schema": ANSWER_SCHEMA,
        "id": derive_case_id(case.spec),
        "spec": asdict(case.spec),
        "verdict": choose_expected_verdict(case),
        "effects": [_describe(case, index) for index in range(len(case.concealed))],
        "shifted_parameters": shifted,
        "enr": case.enr,
        "rows": int(case.left.size),
        "location": {"time": case.intervals},
        "joint": case.scene.joint.fields
        | {
            "family": case.scene.joint.family,
            "core": _name_core(case),
            "noise": case.scene.joint.noise,
            "noise_kind": case.sensors.noise_kind,
        },
    }


def _name_core(case: Case) -> str:
    """The friction core that was simulated; presliding brings its own."""
    number = case.change.plant.get("core")
    return case.scene.joint.core if number is None else next(name for name, own in CORES.items() if own == number)


def _describe(case: Case, index: int) -> dict[str, Any]:
    each: Concealed = case.concealed[index]
    comparable = each.change.parameters if each.form.shared else fit_catalogue(each, case.outcome)
    if case.spec.hidden:  # without a recorded temperature nothing is known by the kelvin
        comparable = {name: truth for name, truth in comparable.items() if not truth.unit.endswith("/K")}
    return {
        "name": each.effect.name,
        "kind": each.effect.kind,
        "form": each.form.name,
        "shared_form": each.form.shared,
        "amplitude": each.amplitude,
        "enr": each.enr,
        "separable_enr": _compute_separable(case, index),
        "localised": each.effect.localised,
        "accepted": [*each.effect.accepted, *(["unknown_physics"] if case.spec.hidden else [])],
        "parameters": {name: asdict(truth) for name, truth in each.change.parameters.items()},
        "comparable": {name: asdict(truth) for name, truth in comparable.items()},
    }


def _compute_separable(case: Case, index: int) -> float:
    """Strength of one effect after the refit of everything else that is concealed, at most what it has alone.

    Each effect's torque is of a run with it alone. Where one changes how another acts, as presliding does with what
    acts about reversals, the rows of the run with both would make more of it than there is.
    """
    each = case.concealed[index]
    others = [other.torque for i, other in enumerate(case.concealed) if i != index]
    if not others:
        return each.enr
    beside = compute_enr(compute_left_after_refit(each.torque, case.outcome.rows, each.effect.against, others))
    return min(beside, each.enr)


def _write_table(columns: dict[str, NDArray[np.float64]], metadata: dict[str, Any], path: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    table = pyarrow.table({name: np.ascontiguousarray(values) for name, values in columns.items()})
    if metadata:
        table = table.replace_schema_metadata({b"fricomp.recording": json.dumps(metadata).encode()})
    with whole_file(path) as part:
        pyarrow.parquet.write_table(table, part)
