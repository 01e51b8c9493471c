"""Vendor profiles: ranges of every model and the registers of its drive, as data with their source."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Literal

import msgspec

from fricomp.errors import AdapterConfigurationError

from .codec import MitRanges

__all__ = ["Register", "Registers", "VendorProfile", "find_model", "vendor_profiles"]

RegisterType = Literal["float32", "uint32", "uint8"]


class Register(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A number in a drive.

    Attributes:
        number: Where it is.
        type: What its four bytes are.
        count: Unit of one count in SI; 1 where it is in SI already.
        required: The value it must have for torque commands to work; none where any does.
    """

    number: int
    type: RegisterType = "float32"
    count: float = 1.0
    required: int | None = None


class Registers(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where a vendor keeps what is read at connecting; None where it cannot be read.

    Attributes:
        position: Range of position [rad].
        velocity: Range of velocity [rad/s].
        torque: Range of torque [N·m].
        mode: Control mode.
        watchdog: Time of silence until the motor stops [s].
    """

    position: Register | None = None
    velocity: Register | None = None
    torque: Register | None = None
    mode: Register | None = None
    watchdog: Register | None = None


class ModelRanges(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Ranges of one model; see `MitRanges`."""

    position: float
    velocity: float
    torque: float
    kp: float = 500.0
    kd: float = 5.0


class VendorProfile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One vendor's file.

    Attributes:
        dialect: Which codec its motors speak.
        source: Where the numbers come from.
        models: Ranges by name of the model.
        registers: Of its drives.
        feedback_offset: Default identifier of answers, added to the motor's own; None if `feedback_id` holds.
        feedback_id: Default identifier of answers.
    """

    dialect: Literal["damiao", "ak", "robstride", "cybergear"]
    source: str
    models: dict[str, ModelRanges]
    registers: Registers = Registers()
    feedback_offset: int | None = None
    feedback_id: int = 0


@cache
def vendor_profiles() -> Mapping[str, VendorProfile]:
    """All profiles, by name of their file."""
    folder = files(__package__) / "profiles"
    return {
        entry.name.removesuffix(".toml"): msgspec.convert(tomllib.loads(entry.read_text("utf-8")), VendorProfile)
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.name.endswith(".toml")
    }


def find_model(name: str) -> tuple[VendorProfile, MitRanges]:
    """The vendor's profile and the ranges of a model called `vendor/model`, such as `damiao/DM4310`.

    Raises:
        AdapterConfigurationError: There is none of this name.
    """
    vendor, _, model = name.partition("/")
    profiles = vendor_profiles()
    if vendor not in profiles or model not in profiles[vendor].models:
        known = [f"{v}/{m}" for v, profile in profiles.items() for m in profile.models]
        raise AdapterConfigurationError(f"unknown motor model {name!r}; known: {', '.join(known)}")
    return profiles[vendor], MitRanges(**msgspec.structs.asdict(profiles[vendor].models[model]))
