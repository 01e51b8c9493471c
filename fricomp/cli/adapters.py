"""`fricomp adapters`: which buses and drives there are."""

from __future__ import annotations

import typer

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp adapters")
def adapters() -> None:
    """List the adapters, those of other packages included, and what each needs installed."""
    from rich.table import Table

    from fricomp.adapters.registry import BUILT_IN, REFUSED, adapter_class, adapter_names
    from fricomp.cli.terminal import console
    from fricomp.errors import FricompError

    table = Table("backend", "what it drives", "from", "loads here")
    for name in adapter_names():
        try:
            found = adapter_class(name)
            summary, usable = (found.__doc__ or "").partition("\n")[0].rstrip("."), "yes"
        except FricompError as error:
            summary, usable = "", f"no: {error}"
        table.add_row(name, summary, "fricomp" if name in BUILT_IN or name == "sim" else "plug-in", usable)
    for name, reason in REFUSED.items():
        table.add_row(name, f"refused: {reason}", "", "no")
    console().print(table)
