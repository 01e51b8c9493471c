"""`fricomp twin`: a simulated drive behind a real protocol, to try everything without hardware."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fricomp.cli.option.panel import Overwrite

if TYPE_CHECKING:
    from fricomp.sim_bench.twins import DriveTwin

app = typer.Typer(add_completion=False)

_MARK = "# Written by fricomp twin; the next one replaces it."

_EPILOG = """
fricomp twin canopen --write-config drive.toml

fricomp calibrate --backend canopen --config drive.toml --out runs/twin

fricomp twin moteus --link tcp --tcp-port 4001

docs/twins.md says what a configuration file of a twin holds.
"""


@app.command(epilog=_EPILOG)
def twin(
    protocol: Annotated[
        Literal["canopen", "dynamixel", "mit", "moteus", "odrive"], typer.Argument(help="Protocol of the drive.")
    ],
    config: Annotated[Path | None, typer.Option(help="TOML file: link, drives, joints.")] = None,
    link: Annotated[
        Literal["pty", "tcp", "can"] | None,
        typer.Option(help="How the twin is reached; this overrides the configuration."),
    ] = None,
    tcp_port: Annotated[int, typer.Option(help="TCP port; 0 for any free one.")] = 0,
    write_config: Annotated[Path | None, typer.Option(help="Write an adapter configuration that reaches it.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Serve a drive with a simulated joint behind it in real time, until Ctrl-C."""
    from fricomp.adapters.configuration import read_table
    from fricomp.cli.output import answer
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.twins import TwinServer
    from fricomp.sim_bench.twins.configuration import make_twin

    if write_config is not None:
        with _claim_config(write_config, config, overwrite=overwrite):
            pass  # what could not be written is refused before a drive is served
    table = read_table(config) if config is not None else {}
    given = {name: value for name, value in (("kind", link), ("tcp_port", tcp_port)) if value}
    table["link"] = {**table.get("link", {}), **given}
    with make_twin(protocol, table) as served, TwinServer(served, real_time=True) as server:
        screen = console()
        names = ", ".join(joint.name for joint in served.stand_in.settings.joints)
        screen.print(f"{protocol} twin of {names}: {_address(protocol, served, table['link'])}", soft_wrap=True)
        if write_config is not None:
            with _claim_config(write_config, config, overwrite=overwrite):
                _write_config(write_config, protocol, served)
            screen.print(f"in another terminal: fricomp calibrate --backend {protocol} --config {write_config}")
        screen.print("Ctrl-C ends it.")
        answer(
            {"protocol": protocol, "joints": names.split(", "), "address": _address(protocol, served, table["link"])}
        )
        server.wait()
        if server.error is not None:
            raise server.error


def _address(protocol: str, served: DriveTwin, link: dict[str, Any]) -> str:
    """Where an adapter finds it."""
    from fricomp.sim_bench.twins.adapter_table import twin_address
    from fricomp.sim_bench.twins.configuration import CAN_PROTOCOLS

    address = twin_address(served)
    if address is None:
        return f"interface {link.get('interface', 'virtual')}, channel {link.get('channel')}"
    return f"interface slcan-chunked, channel {address}" if protocol in CAN_PROTOCOLS else f"serial port {address}"


def _claim_config(path: Path, read: Path | None, *, overwrite: bool) -> AbstractContextManager[None]:
    """Keep the files of an adapter's configuration to this process; those of an earlier twin may be replaced."""
    from fricomp.results import claim_single_files

    inputs = [read] if read is not None else []
    return claim_single_files([path, _endpoints(path)], overwrite=overwrite or _is_of_a_twin(path), inputs=inputs)


def _endpoints(path: Path) -> Path:
    """Where the endpoints of an ODrive stand beside its configuration."""
    return path.with_suffix(".endpoints.json")


def _write_config(path: Path, protocol: str, served: DriveTwin) -> None:
    import json

    from fricomp.sim_bench.twins.adapter_table import adapter_configuration
    from fricomp.whole_file import write_whole

    endpoints = _endpoints(path)
    if protocol == "odrive":
        from fricomp.sim_bench.twins.odrive import flat_endpoints

        write_whole(endpoints, json.dumps(flat_endpoints(), indent=1))
    write_whole(path, f"{_MARK}\n\n{adapter_configuration(protocol, served, str(endpoints.resolve()))}")


def _is_of_a_twin(path: Path) -> bool:
    """Whether a configuration is that of an earlier twin, whose address nobody has any more."""
    try:
        with path.open("rb") as file:
            return not path.is_symlink() and file.read(len(_MARK)) == _MARK.encode()
    except OSError:
        return False
