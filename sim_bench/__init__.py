"""The stand-in joint, the drive twins, the diagnosis of a mismatch, and its proof."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .diagnosis import diagnose

__all__ = ["diagnose"]


def __getattr__(name: str) -> Any:
    """Import `diagnose` when it is first asked for; it needs the extra `diagnose`."""
    if name == "diagnose":
        from .diagnosis import diagnose

        return diagnose
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
