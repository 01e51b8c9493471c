"""The stand-in's table in a configuration file, checked key by key."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from fricomp.control import JointLimits
from fricomp.errors import ParameterError
from fricomp.laws import FrictionLaw
from fricomp.model import load_model
from fricomp.simulation_file import list_joints
from fricomp.untrusted import convert_table

from .disturbance import Disturbance, Sinusoid
from .packaged import (
    DEFAULT_LAW,
    PACKAGED_MODELS,
    default_joint,
    packaged_model,
    sensors_for,
    six_joint_arm,
    two_link_arm,
)
from .plant import NormalLoad, ThermalSettings
from .sensor import SensorSettings
from .servo import ServoSettings
from .stand_in import JointSettings, StandInSettings

_Settings = TypeVar("_Settings", SensorSettings, ServoSettings, ThermalSettings)


class JointTable(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """One joint; what is left out keeps its default.

    Attributes:
        name: Its name in the MJCF file.
        friction: A model file (`friction.json`) with the friction it is to have; table I of [luo2024pinn] without.
        sensor: Fields of `SensorSettings`.
        ideal_sensor: No quantisation, noise, filter or delay.
        servo: Fields of `ServoSettings`.
        thermal: Fields of `ThermalSettings`.
        normal_load: A number, or "transmitted".
        disturbance: External torque, a list of sinusoids.
        position: Where it starts [rad] or [m].
        limits: Limits of the safety gate.
    """

    name: str
    friction: str | None = None
    sensor: dict[str, int | float] = {}
    ideal_sensor: bool = False
    servo: dict[str, int | float] = {}
    thermal: dict[str, int | float] = {}
    normal_load: float | Literal["transmitted"] | None = None
    disturbance: list[Sinusoid] | None = None
    position: float | None = None
    limits: JointLimits | None = None


class StandInTable(msgspec.Struct, forbid_unknown_fields=True):
    """The whole table.

    Attributes:
        model: `default_joint`, `two_link_arm`, `six_joint_arm`, or the path of an MJCF file.
        joints: Joints to drive; may be left out for the packaged models.
        seed: Of the sensor noise.
        period: Servo, sensor and simulation period [s].
    """

    model: str = "default_joint"
    joints: list[JointTable] = []
    seed: int = 0
    period: float = 1e-3


def read_configuration(configuration: Mapping[str, Any]) -> tuple[StandInSettings, tuple[JointLimits, ...] | None]:
    """Settings of a stand-in, and the limits if every joint gives them.

    Raises:
        ParameterError: A key is unknown or a value is wrong.
    """
    try:
        return _settings(convert_table(dict(configuration), StandInTable))
    except msgspec.ValidationError as error:
        raise ParameterError(f"simulated joint: {error}") from error


def _settings(table: StandInTable) -> tuple[StandInSettings, tuple[JointLimits, ...] | None]:
    base = _base(table)
    by_name = {joint.name: joint for joint in base}
    tables = table.joints or [JointTable(name) for name in by_name]
    joints = tuple(_joint(entry, by_name.get(entry.name) or _plain_joint(entry.name)) for entry in tables)
    mjcf = packaged_model(table.model) if table.model in PACKAGED_MODELS else Path(table.model)
    limits = [entry.limits for entry in tables if entry.limits is not None]
    if limits and len(limits) != len(tables):
        raise ParameterError("limits are given for some joints only: give them for all or for none")
    return StandInSettings(mjcf, joints, table.period, table.seed), tuple(limits) or None


def _base(table: StandInTable) -> tuple[JointSettings, ...]:
    if table.model == "default_joint":
        return default_joint().joints
    if table.model == "two_link_arm":
        return two_link_arm().joints
    if table.model == "six_joint_arm":
        return six_joint_arm().joints
    if not table.joints:
        names = ", ".join(list_joints(table.model))
        raise ParameterError(
            f"name the joints of {table.model!r} that are to be driven, in the file of --config: [[joints]] with "
            f'name = "..." for each; it has {names or "none"}'
        )
    return ()


def _plain_joint(name: str) -> JointSettings:
    return JointSettings(name, DEFAULT_LAW, sensors_for(DEFAULT_LAW))


def _joint(entry: JointTable, base: JointSettings) -> JointSettings:
    law: FrictionLaw = load_model(entry.friction).law if entry.friction is not None else base.law
    sensor = SensorSettings.ideal() if entry.ideal_sensor else sensors_for(law)
    load: NormalLoad = entry.normal_load
    return JointSettings(
        name=entry.name,
        law=law,
        sensor=_changed(sensor, "sensor", entry.sensor),
        servo=_changed(base.servo, "servo", entry.servo),
        normal_load=load,
        thermal=_changed(ThermalSettings(), "thermal", entry.thermal),
        disturbance=base.disturbance if entry.disturbance is None else Disturbance(tuple(entry.disturbance)),
        position=base.position if entry.position is None else entry.position,
    )


def _changed(base: _Settings, what: str, values: dict[str, int | float]) -> _Settings:
    known = asdict(base)
    unknown = sorted(set(values) - set(known))
    if unknown:
        raise ParameterError(f"{what} has no field {', '.join(unknown)}; known: {', '.join(known)}")
    return msgspec.convert(known | values, type(base))
