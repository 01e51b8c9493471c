"""Adapters by name: those of this package, and those that others register under `fricomp.adapters`."""

import warnings
from collections.abc import Mapping
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from fricomp.errors import AdapterConfigurationError

from .adapter import JointAdapter
from .configuration import ConfigurationTable

__all__ = ["ENTRY_POINT_GROUP", "adapter_class", "adapter_names", "open_adapter"]

ENTRY_POINT_GROUP = "fricomp.adapters"

# Name to "module:class", loaded when asked for, so that a missing bus library is missed only by who needs it.
BUILT_IN: Mapping[str, str] = {
    "canopen": "fricomp.adapters.canopen:CanOpenAdapter",
    "dynamixel": "fricomp.adapters.dynamixel:DynamixelAdapter",
    "mit": "fricomp.adapters.mit:MitAdapter",
    "moteus": "fricomp.adapters.moteus:MoteusAdapter",
    "odrive": "fricomp.adapters.odrive:OdriveAdapter",
}

# Asked for by name and refused, with the reason.
REFUSED: Mapping[str, str] = {
    "feetech": "Feetech STS and SCS servos take positions, speeds and PWM but no torque or current, "
    "so that friction can neither be compensated nor told from their own position loop",
}


def adapter_names() -> tuple[str, ...]:
    """Names of all adapters that can be asked for, sorted."""
    return tuple(sorted(set(BUILT_IN) | set(_plugins())))


def adapter_class(name: str) -> type[JointAdapter]:
    """The adapter registered as `name`; one of this package wins over a plug-in of the same name.

    Raises:
        AdapterConfigurationError: No adapter has this name, or it is a broken plug-in.
    """
    if name in REFUSED:
        raise AdapterConfigurationError(f"backend {name!r} is refused: {REFUSED[name]}")
    if name in BUILT_IN:
        module, _, attribute = BUILT_IN[name].partition(":")
        found = getattr(import_module(module), attribute)
    elif name in (plugins := _plugins()):
        found = _load(plugins[name])
    else:
        raise AdapterConfigurationError(f"unknown backend {name!r}; known: {', '.join(adapter_names())}")
    if not (isinstance(found, type) and issubclass(found, JointAdapter)):
        raise AdapterConfigurationError(f"backend {name!r} is not a JointAdapter: {found!r}")
    return found


def open_adapter(name: str, configuration: Mapping[str, Any] | None = None) -> JointAdapter:
    """An adapter made from its configuration, not yet opened.

    Args:
        name: One of `adapter_names()`.
        configuration: As read from the configuration file; each adapter says what it takes. `backend` may stand in
            it, and is this name then.

    Raises:
        AdapterConfigurationError: The name or the configuration is wrong, or the configuration is for another backend.
    """
    found, given = adapter_class(name), dict(configuration or {})
    if isinstance(configuration, ConfigurationTable):
        given = ConfigurationTable(given, configuration.path)
    named = given.pop("backend", None)
    if named not in (None, name):
        raise AdapterConfigurationError(f"the configuration is for backend {named!r}, but {name!r} is asked for")
    made = found.from_configuration(given)
    if isinstance(configuration, ConfigurationTable):
        made.configuration_file = configuration.path
    return made


def _plugins() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}


def _load(point: EntryPoint) -> object:
    try:
        return point.load()
    except Exception as error:  # a plug-in may fail in any way; nothing has been opened yet
        warnings.warn(f"the adapter plug-in {point.name!r} ({point.value}) does not load: {error}", stacklevel=3)
        raise AdapterConfigurationError(f"backend {point.name!r} does not load: {error}") from error
