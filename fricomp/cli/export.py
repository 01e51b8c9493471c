"""`fricomp export`: a model as C, ONNX, MJCF, URDF, JSON or settings of a training simulator, with what is lost."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fricomp.cli.option.panel import Overwrite

if TYPE_CHECKING:
    from fricomp.export.simulators import MjcfWay
    from fricomp.model import FrictionModel

app = typer.Typer(add_completion=False)

EPILOG = """fricomp export friction.json --to c --out friction.h

fricomp export friction.json --to mjcf --into robot.xml --joint elbow --out robot_with_friction.xml

fricomp export joint1/friction.onnx joint2/friction.onnx --to onnx --out arm.onnx

fricomp export joint1/friction.json joint2/friction.json --to isaaclab --out friction_settings.py"""


Target = Literal["c", "onnx", "mjcf", "urdf", "json", "isaaclab", "mjlab", "newton", "ros2"]


@app.command(epilog=EPILOG)
def export(
    models: Annotated[list[Path], typer.Argument(help="Model files; several for --to onnx and settings.")],
    to: Annotated[Target, typer.Option(help="Format.")],
    out: Annotated[Path | None, typer.Option(help="File to write; the terminal for text if left out.")] = None,
    way: Annotated[
        Literal["dcmotor", "damping", "frictionloss"],
        typer.Option(help="MJCF: passive motor, damping polynomial, or friction loss."),
    ] = "dcmotor",
    into: Annotated[Path | None, typer.Option(help="MJCF or URDF file to write the friction into.")] = None,
    joint: Annotated[str | None, typer.Option(help="Joint's name there; the model's own if left out.")] = None,
    period: Annotated[float, typer.Option(help="C: control period [s].")] = 1e-3,
    prefix: Annotated[
        str | None, typer.Option(help="C: prefix of every name; friction_ and the joint's name if left out.")
    ] = None,
    any_status: Annotated[
        bool, typer.Option("--any-status", help="Export a model too that its identification calls unusable.")
    ] = False,
    overwrite: Overwrite = False,
) -> None:
    """Write a model in another format, and say what that format cannot hold."""
    from fricomp.cli.output import answer, hearing
    from fricomp.cli.terminal import console
    from fricomp.errors import ExportError
    from fricomp.results import claim_single_files
    from fricomp.whole_file import write_whole

    text, inputs = "", [*models, *([into] if into is not None else [])]
    with claim_single_files([] if out is None else [out], overwrite=overwrite, inputs=inputs):
        if to == "onnx":
            if out is None:
                raise ExportError("ONNX is binary: say where with --out")
            note = _export_onnx(models, out, any_status)
        else:
            text, note = _render_text(
                models, to, any_status, way=way, into=into, joint=joint, period=period, prefix=prefix
            )
            if out is not None:
                write_whole(out, text, ExportError)
            elif not hearing().as_json:
                print(text, end="")
    answer({"format": to, "file": out, "text": text if out is None else None, "fidelity": note})
    console(stderr=True).print(note if out is None else f"{out}: {note}", soft_wrap=True)


def _render_text(models: list[Path], to: Target, any_status: bool, **options: Any) -> tuple[str, str]:
    """The text, and what it loses; `options` are those of `_render`."""
    from fricomp.errors import ExportError
    from fricomp.export import TRAINING_FORMATS

    if to in TRAINING_FORMATS:
        return _render_settings(models, to, any_status)
    if len(models) != 1:
        several = ", ".join(["onnx", *TRAINING_FORMATS])
        raise ExportError(f"{len(models)} models given; --to {to} takes one, several are for --to {several}")
    return _render(models[0], to, any_status, **options)


def _render_settings(paths: list[Path], to: Target, any_status: bool) -> tuple[str, str]:
    """Settings of a training simulator, and what they lose joint by joint."""
    from fricomp.errors import ExportError
    from fricomp.export import fit_friction_levels, render_training
    from fricomp.model import load_model

    levels = [fit_friction_levels(load_model(path), any_status=any_status) for path in paths]
    names = [each.joint for each in levels]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ExportError(f"two models are of joint {', '.join(twice)}: give one model for each joint")
    return render_training(levels, to), "; ".join(f"{each.joint}: {each.fidelity}" for each in levels)


def _export_onnx(paths: list[Path], out: Path, any_status: bool) -> str:
    from fricomp.errors import ExportError
    from fricomp.export import closed_form_graph, join_facts, save_graph, stack_networks, state_columns
    from fricomp.model import load_model

    kinds = {path.suffix for path in paths}
    if kinds == {".onnx"}:
        save_graph(stack_networks(paths, any_status=any_status), out)
        return (
            f"the networks of {len(paths)} joints in one graph; only rounding to float32 is lost, and of their ranges "
            "of velocity what not all of them share"
        )
    if ".onnx" in kinds:
        raise ExportError("networks (.onnx) and closed forms (.json) cannot be mixed in one graph")
    models = [load_model(path) for path in paths]
    columns = state_columns(models)
    metadata = join_facts([_facts(model) for model in models]) | {"input": ", ".join(columns)}
    save_graph(closed_form_graph(models, any_status=any_status), out, metadata)
    joints = f"{len(models)} joint{'s' if len(models) > 1 else ''}"
    memory = ", in steady sliding" if any(model.law.is_dynamic for model in models) else ""
    return f"the closed form of {joints} over {', '.join(columns)}; only rounding to float32 is lost{memory}"


def _facts(model: FrictionModel) -> dict[str, str]:
    """What the metadata of a graph say of a joint; how much it may claim is in the graph itself."""
    facts = {"joint": model.joint, "output": f"torque [{model.torque_unit}]"}
    if model.provenance.status:
        facts |= {"status": model.provenance.status, "message": model.provenance.message}
    if model.validity.velocity is not None:
        facts["velocity_range"] = " ".join(f"{edge:.9g}" for edge in model.validity.velocity)
    return facts


def _render(
    path: Path,
    to: Target,
    any_status: bool,
    *,
    way: MjcfWay,
    into: Path | None,
    joint: str | None,
    period: float,
    prefix: str | None,
) -> tuple[str, str]:
    from fricomp.export import apply_to_mjcf, apply_to_urdf, export_mjcf, export_urdf, render_c_header
    from fricomp.model import encode_model, load_model
    from fricomp.version import __version__

    model, text = load_model(path), _read(into) if into is not None else None
    if to == "json":
        return encode_model(model).decode(), "nothing is lost"
    if to == "c":
        header = render_c_header(model, period=period, prefix=prefix, version=__version__, any_status=any_status)
        return (
            header,
            "the same curve, smoothing and limits; double within 1e-12, float within 1e-6 of the largest torque",
        )
    if to == "mjcf":
        export = export_mjcf(model, way, any_status=any_status)
        return apply_to_mjcf(export, text, joint or model.joint), str(export.fidelity)
    export = export_urdf(model, any_status=any_status)
    return apply_to_urdf(export, text, joint or model.joint), str(export.fidelity)


def _read(path: Path) -> str:
    """The MJCF or URDF file to write into; an editor's byte order mark is no part of it."""
    from fricomp.errors import ExportError
    from fricomp.untrusted import read_whole

    try:
        return read_whole(path).decode("utf-8-sig")
    except OSError as error:
        raise ExportError(f"cannot read {path}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise ExportError(f"{path} is no text in UTF-8: --into takes an MJCF or URDF file") from error
