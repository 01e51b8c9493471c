"""The stand-in joint, the drive twins, the diagnosis of a mismatch, and its proof."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .diagnosis import diagnose, diagnose_against

__all__ = ["diagnose", "diagnose_against"]


def __getattr__(name: str) -> Any:
    """Import what diagnoses when it is first asked for; it needs the extra `diagnose`."""
    if name in __all__:
        from . import diagnosis

        return getattr(diagnosis, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
