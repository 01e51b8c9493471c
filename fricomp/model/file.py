"""The model file: JSON with a schema and its version. Nothing in it is ever executed."""

import hashlib
import os
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_type_hints

import msgspec
import numpy as np

from fricomp.errors import FricompError, ModelFileError
from fricomp.laws import FrictionLaw, Term, term_class
from fricomp.model.dynamics import JointDynamics
from fricomp.model.model import Covariance, FrictionModel, Motion, Provenance, Validity
from fricomp.untrusted import parse_json, read_whole
from fricomp.whole_file import write_whole

MODEL_SCHEMA = "fricomp.model/1"
_FAMILY, _VERSION = MODEL_SCHEMA.split("/")
_UNIT_OF_LOADS = "as normal_load"


class _Quantity(msgspec.Struct, forbid_unknown_fields=True):
    value: float
    unit: str
    standard_deviation: float | None = None


class _TermRecord(msgspec.Struct, forbid_unknown_fields=True):
    term: str
    parameters: dict[str, _Quantity]
    options: dict[str, str] = {}


class _CovarianceRecord(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    names: tuple[str, ...]
    matrix: list[list[float]]
    degrees_of_freedom: float | None = None


class _ModelRecord(msgspec.Struct, forbid_unknown_fields=True):
    schema: str
    joint: str
    motion: Motion
    torque_unit: str
    law: list[_TermRecord]
    validity: Validity
    provenance: Provenance
    covariance: _CovarianceRecord | None = None
    dynamics: dict[str, _Quantity] | msgspec.UnsetType = msgspec.UNSET


class _Header(msgspec.Struct):
    schema: str


def model_json_schema() -> dict[str, Any]:
    """The JSON schema of the model file."""
    return msgspec.json.schema(_ModelRecord)


def save_model(model: FrictionModel, path: str | os.PathLike[str]) -> str:
    """Write `model` as JSON, whole or not at all.

    Returns:
        SHA-256 of the file's bytes, in hexadecimal.

    Raises:
        ModelFileError: The file cannot be written, or a text of the model is none in UTF-8.
    """
    if not isinstance(model, FrictionModel):
        raise ModelFileError(
            f"{type(model).__name__} is no friction model: give a FrictionModel, such as .model of a result"
        )
    try:
        data = encode_model(model)
    except UnicodeEncodeError as error:
        raise ModelFileError(f"cannot write {path}: {error.object!r} of the model is no text in UTF-8") from error
    write_whole(Path(path), data, ModelFileError)
    return hashlib.sha256(data).hexdigest()


def load_model(path: str | os.PathLike[str]) -> FrictionModel:
    """Read a model file.

    Args:
        path: The file, or the folder of a calibration, identification or diagnosis with its `friction.json`.

    Raises:
        ModelFileError: The file is missing, damaged, foreign, in units of its own, or written by a newer version.
    """
    if not isinstance(path, str | os.PathLike):
        raise ModelFileError(f"{type(path).__name__} is no path of a model file: give that of a friction.json")
    if os.path.isdir(path):
        path = os.path.join(path, "friction.json")
    try:
        data = read_whole(path)
    except OSError as error:
        raise ModelFileError(f"cannot read the model file {path}: {error.strerror or error}") from error
    return decode_model(data, str(path))


def encode_model(model: FrictionModel) -> bytes:
    """The bytes of the model file."""
    covariance = model.covariance
    deviations = covariance.standard_deviations() if covariance else {}
    units = model.units()
    record = _ModelRecord(
        schema=MODEL_SCHEMA,
        joint=model.joint,
        motion=model.motion,
        torque_unit=model.torque_unit,
        law=[
            _TermRecord(
                term=term.name,
                parameters={
                    name: _Quantity(value, units[f"{term.name}.{name}"], deviations.get(f"{term.name}.{name}"))
                    for name, value in term.parameters().items()
                },
                options=_options(term),
            )
            for term in model.law.terms
        ],
        validity=model.validity,
        provenance=model.provenance,
        covariance=None
        if covariance is None
        else _CovarianceRecord(covariance.names, covariance.matrix.tolist(), covariance.degrees_of_freedom),
        dynamics=_dynamics_record(model),
    )
    return msgspec.json.format(msgspec.json.encode(record), indent=2) + b"\n"


def _dynamics_record(model: FrictionModel) -> dict[str, _Quantity] | msgspec.UnsetType:
    if model.dynamics is None:
        return msgspec.UNSET
    units = model.dynamics.units(model.torque_unit, model.position_unit)
    return {name: _Quantity(value, units[name]) for name, value in vars(model.dynamics).items()}


def decode_model(data: bytes, source: str = "the model") -> FrictionModel:
    """The model in the bytes of a model file; `source` names it in errors.

    Raises:
        ModelFileError: The bytes are damaged, foreign, in units of their own, or written by a newer version.
    """
    try:
        schema = parse_json(data, _Header).schema
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise ModelFileError(f"{source} is not a fricomp model file, or is damaged: {error}") from error
    family, _, version = schema.partition("/")
    if family != _FAMILY or not version.isdecimal() or int(version) < 1:
        raise ModelFileError(f"{source} has schema {schema!r}; a model file has {MODEL_SCHEMA!r}")
    if int(version) > int(_VERSION):
        raise ModelFileError(f"{source} has schema {schema!r}, newer than {MODEL_SCHEMA!r}: upgrade fricomp to read it")
    try:
        record = parse_json(data, _ModelRecord)
        model = _model(record)
    except (msgspec.DecodeError, FricompError, TypeError) as error:
        raise ModelFileError(f"{source} is damaged: {error}") from error
    _require_units(record, model, source)
    return model


def _require_units(record: _ModelRecord, model: FrictionModel, source: str) -> None:
    """Refuse a value in another unit than the model writes: it would count as if it were in that one.

    A reference load may name any unit, because a model does not know the one of its loads.
    """
    units: Mapping[str, str] = model.units()
    stated = {f"{t.term}.{name}": quantity.unit for t in record.law for name, quantity in t.parameters.items()}
    if model.dynamics is not None and record.dynamics is not msgspec.UNSET:
        units = {**units, **model.dynamics.units(model.torque_unit, model.position_unit)}
        stated |= {name: quantity.unit for name, quantity in record.dynamics.items()}
    for name, unit in stated.items():
        if unit != units[name] != _UNIT_OF_LOADS:
            raise ModelFileError(
                f"{source} gives {name} in {unit!r}; a {record.motion} model with torque in {record.torque_unit} has "
                f"{units[name]!r} there: convert the value"
            )


def _model(record: _ModelRecord) -> FrictionModel:
    covariance = record.covariance
    return FrictionModel(
        law=FrictionLaw(tuple(_term(term) for term in record.law)),
        joint=record.joint,
        motion=record.motion,
        torque_unit=record.torque_unit,
        validity=record.validity,
        covariance=None
        if covariance is None
        else Covariance(covariance.names, np.array(covariance.matrix), covariance.degrees_of_freedom),
        provenance=record.provenance,
        dynamics=None if record.dynamics is msgspec.UNSET else _dynamics(record.dynamics),
    )


def _dynamics(record: Mapping[str, _Quantity]) -> JointDynamics:
    made: JointDynamics = _build(JointDynamics, {name: quantity.value for name, quantity in record.items()})
    return made


def _options(term: Term) -> dict[str, str]:
    """Fields of a term that are a choice, not a number."""
    return {f.name: getattr(term, f.name) for f in fields(term) if isinstance(getattr(term, f.name), str)}


def _term(record: _TermRecord) -> Term:
    values: dict[str, Any] = {name: quantity.value for name, quantity in record.parameters.items()}
    built: Term = _build(term_class(record.term), values | record.options)
    return built


def _build(cls: type[Any], values: dict[str, Any]) -> Any:
    """Make the dataclass `cls` from dotted names."""
    hints, unknown = get_type_hints(cls), set(values)
    arguments: dict[str, Any] = {}
    for field in fields(cls):
        names = {name for name in values if name.startswith(f"{field.name}.")}
        if not is_dataclass(hints[field.name]):
            names = {field.name} & set(values)
            arguments |= {name: values[name] for name in names}
        elif names:
            arguments[field.name] = _build(hints[field.name], {name.partition(".")[2]: values[name] for name in names})
        unknown -= names
    if unknown:
        raise ModelFileError(f"{cls.__name__} has no parameter {', '.join(sorted(unknown))}")
    return cls(**arguments)
