"""The extras: which of them brings a package that is not installed, and refusing early what needs one."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from fricomp.errors import MissingExtraError

REPORT = ("matplotlib", "jinja2", "plotly")
"""What draws a report: imported last of all, and asked for before anything moves or is thrown away."""

# Import name to distribution, where they differ.
_DISTRIBUTION = {
    "can": "python-can",
    "serial": "pyserial",
    "sklearn": "scikit-learn",
    "distributed": "dask",
    "mcap_protobuf": "mcap-protobuf-support",
}
_REQUIREMENT = re.compile(r"^([A-Za-z0-9_.-]+).*extra == ['\"]([a-z]+)['\"]")
_COLLECTIVE = ("all", "dev")


def extra_for(module: str) -> str | None:
    """The extra that brings the package of `module`, or None where fricomp knows of none."""
    from importlib.metadata import PackageNotFoundError, requires

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


def is_installed(module: str) -> bool:
    """Whether a package can be imported; it is not imported."""
    return find_spec(module) is not None


@contextmanager
def needing(package: str, extra: str) -> Iterator[None]:
    """Import a package of an extra in here, so that its absence says how to install it.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        yield
    except ImportError as error:
        raise MissingExtraError(package, extra) from error


def require(*modules: str, extra: str = "") -> None:
    """Refuse to begin what could not be brought to its end.

    Args:
        modules: Import names of the packages that will be needed.
        extra: Brings them, where no extra of a user does.

    Raises:
        MissingExtraError: One is not installed.
    """
    for module in modules:
        if not is_installed(module):
            raise MissingExtraError(module, extra or extra_for(module) or "all")
