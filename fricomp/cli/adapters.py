"""`fricomp adapters`: which buses and drives there are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from fricomp.adapters import JointAdapter

__all__ = ["EXTRAS", "app"]

app = typer.Typer(add_completion=False)

EXTRAS = {
    "canopen": ("can",),
    "dynamixel": ("serial",),
    "mit": ("can",),
    "moteus": ("serial",),
    "odrive": ("can",),
    "sim": ("sim",),
    "twin-canopen": ("can", "sim"),
    "twin-dynamixel": ("can", "sim"),
    "twin-mit": ("can", "sim"),
    "twin-moteus": ("can", "sim"),
    "twin-odrive": ("can", "sim"),
}
"""Adapter of this package to the extras that it needs; the memory of every twin holds CAN frames."""

_MODULES = {"can": ("can", "canopen"), "serial": ("serial",), "sim": ("mujoco",)}


@app.command(epilog="fricomp adapters")
def adapters() -> None:
    """List the adapters, those of other packages included, and what each needs installed."""
    from rich.table import Table

    from fricomp.adapters.registry import REFUSED, adapter_names
    from fricomp.cli.terminal import console

    table = Table("backend", "what it drives", "from", "needs the extra", "installed")
    for name in adapter_names():
        table.add_row(name, *(_shipped(name) if name in EXTRAS else _plugged_in(name)))
    for name, reason in REFUSED.items():
        table.add_row(name, f"refused: {reason}", "", "", "no")
    console().print(table)


def _shipped(name: str) -> tuple[str, str, str, str]:
    """What it drives, that it is from here, its extras, and which of them are missing."""
    from fricomp.adapters.registry import adapter_class
    from fricomp.extras import is_installed

    missing = [extra for extra in EXTRAS[name] if not all(map(is_installed, _MODULES[extra]))]
    summary = _summary(adapter_class(name)) if not missing else ""
    wanted = f"no: pip install '.[{','.join(missing)}]'" if missing else "yes"
    return summary, "fricomp", ", ".join(EXTRAS[name]), wanted


def _plugged_in(name: str) -> tuple[str, str, str, str]:
    """The same of another package's adapter, which has to be loaded to be known."""
    from fricomp.adapters.registry import adapter_class
    from fricomp.errors import FricompError

    try:
        return _summary(adapter_class(name)), "plug-in", "", "yes"
    except FricompError as error:
        return "", "plug-in", "", f"no: {error}"


def _summary(adapter: type[JointAdapter]) -> str:
    return (adapter.__doc__ or "").partition("\n")[0].rstrip(".")
