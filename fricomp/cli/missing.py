"""Which extra of fricomp brings a package that is not installed."""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError, requires

__all__ = ["extra_for"]

# Import name to distribution, where they differ.
_DISTRIBUTION = {"can": "python-can", "serial": "pyserial", "sklearn": "scikit-learn", "distributed": "dask"}
_REQUIREMENT = re.compile(r"^([A-Za-z0-9_.-]+).*extra == ['\"]([a-z]+)['\"]")
_COLLECTIVE = ("all", "dev")


def extra_for(module: str) -> str | None:
    """The extra that brings the package of `module`, or None where fricomp knows of none."""
    top = module.partition(".")[0]
    wanted = _DISTRIBUTION.get(top, top).lower()
    try:
        entries = requires("fricomp") or []
    except PackageNotFoundError:
        return None
    for entry in entries:
        match = _REQUIREMENT.match(entry)
        if match and match[1].lower() == wanted and match[2] not in _COLLECTIVE:
            return match[2]
    return None
