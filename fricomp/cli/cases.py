"""`fricomp cases`: make and list concealed cases, to try the diagnosis on joints whose truth is known."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fricomp.cli.option.panel import Overwrite
from fricomp.cli.output import answer

if TYPE_CHECKING:
    from fricomp.result_kinds import Results

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="Make and list concealed cases: joints with more physics than their simulation, to try the diagnosis on.",
)
_NAMES = "`fricomp cases list` has the names"

_MAKE = """fricomp cases make --effect cogging --strength 1 --excitation fourier --out runs/cases

fricomp cases make --arm --effect shoulder:load_coulomb --out runs/arms"""


@app.command(epilog=_MAKE)
def make(
    out: Annotated[Path, typer.Option(help="Folder for the case; the answer goes into OUT.answers.")],
    effect: Annotated[list[str] | None, typer.Option(help=f"Repeat for several; {_NAMES}; leave out for none.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Draws joint, motion, sensors and effect.")] = 1,
    strength: Annotated[
        str, typer.Option(help="Effect-to-noise ratio after a base refit: 0.1, 0.2, 0.5, 1, 2, 5 or clear.")
    ] = "clear",
    excitation: Annotated[str, typer.Option(help="Motion; `fricomp cases list` has the names.")] = "rich",
    duration: Annotated[float, typer.Option(help="Length of the recording [s].")] = 60.0,
    noise: Annotated[
        str | None, typer.Option(help=f"Kind of torque noise; {_NAMES}; drawn from the seed by default.")
    ] = None,
    core: Annotated[str | None, typer.Option(help=f"Friction core; {_NAMES}; drawn from the seed by default.")] = None,
    family: Annotated[
        str | None, typer.Option(help=f"Family of joints; {_NAMES}; drawn from the seed by default.")
    ] = None,
    form: Annotated[
        str | None, typer.Option(help=f"Functional form of the first effect; {_NAMES}; drawn from the seed by default.")
    ] = None,
    shifted: Annotated[bool, typer.Option("--shifted", help="Believed inertia and gravity are off.")] = False,
    hidden: Annotated[bool, typer.Option("--hidden", help="Load and temperature are not logged.")] = False,
    fault: Annotated[str | None, typer.Option(help=f"Fault of the signal; {_NAMES}; none by default.")] = None,
    arm: Annotated[
        bool, typer.Option("--arm", help="Six joints that move at once; an effect is JOINT:NAME, drawn by default.")
    ] = False,
    overwrite: Overwrite = False,
) -> None:
    """Write recording, simulation and controller of a joint that has more physics than its simulation."""
    if arm:
        _make_arm(out, effect, seed, duration, overwrite=overwrite)
        return
    from fricomp.cli.terminal import console
    from fricomp.errors import DiagnosisError
    from fricomp.result_kinds import CASE
    from fricomp.sim_bench.cases import CaseSpec, derive_case_id, generate, write_answer, write_case

    spec = CaseSpec(
        seed=seed,
        effects=tuple(effect or ()),
        strength=strength,
        excitation=excitation,
        duration=duration,
        noise=noise,
        core=core,
        family=family,
        form=form,
        shifted=shifted,
        hidden=hidden,
        fault=fault,
    )
    if form is not None and not effect:
        raise DiagnosisError("--form is one of an effect: give --effect too")
    with _claim_case(out, CASE, derive_case_id(spec), overwrite=overwrite) as answers:
        case = generate(spec)
        folder = write_case(case, out)
        truth, digest = write_answer(case, answers)
    answer({"case": folder, "answer": truth, "sha256": digest, "enr": case.enr, "rows": case.left.size})
    show = console()
    show.print(f"{folder}: effect-to-noise ratio {case.enr:.3g} over {case.left.size} rows", soft_wrap=True)
    show.print(f"answer {truth}, SHA-256 {digest}", soft_wrap=True)
    given = "--friction " + str(folder / "friction.json") if (folder / "friction.json").exists() else ""
    show.print(
        f"try: fricomp diagnose {folder}/recording.parquet --simulation {folder}/joint.xml "
        f"--controller {folder}/loop.toml {given} --out {folder}/diagnosis".replace("  ", " "),
        soft_wrap=True,
    )


def _make_arm(out: Path, effects: list[str] | None, seed: int, duration: float, *, overwrite: bool) -> None:
    """Write recordings and simulation of an arm, and its answer.

    Raises:
        DiagnosisError: An effect is not JOINT:NAME, or there is no such joint or effect.
    """
    from dataclasses import replace

    from fricomp.cli.terminal import console
    from fricomp.result_kinds import ARM_CASE
    from fricomp.sim_bench.cases.arm import (
        arm_id,
        draw_spec,
        generate_arm,
        parse_effect,
        write_arm_answer,
        write_arm_case,
    )

    spec = draw_spec(seed, duration)
    if effects:
        spec = replace(spec, effects=tuple(map(parse_effect, effects)))
    with _claim_case(out, ARM_CASE, arm_id(spec), overwrite=overwrite) as answers:
        case = generate_arm(spec)
        folder = write_arm_case(case, out)
        truth, digest = write_arm_answer(case, answers)
    answer({"case": folder, "answer": truth, "sha256": digest})
    show = console()
    show.print(f"{folder}: six joints, {duration:g} s at {1.0 / (case.time[1] - case.time[0]):.0f} Hz", soft_wrap=True)
    show.print(f"answer {truth}, SHA-256 {digest}", soft_wrap=True)
    show.print(
        f"try: fricomp diagnose {folder}/log --simulation {folder}/arm.xml --out {folder}/diagnosis", soft_wrap=True
    )


@app.command(epilog="fricomp cases inject emps --effect cogging --strength 2 --out runs/cases")
def inject(
    source: Annotated[str, typer.Argument(help="Public recording; its data must be here.")],
    out: Annotated[Path, typer.Option(help="Folder for the case; the answer goes into OUT.answers.")],
    effect: Annotated[str, typer.Option(help="Effect to add; none by default.")] = "",
    strength: Annotated[str, typer.Option(help="1, 2 or 5 times what a base refit leaves of the recording.")] = "2",
    seed: Annotated[int, typer.Option(min=0, help="Draws order and phase.")] = 1,
    overwrite: Overwrite = False,
) -> None:
    """Add the torque of a known effect, along the measured motion, to a real recording."""
    import json

    from fricomp.cli.terminal import console
    from fricomp.result_kinds import INJECTED_CASE
    from fricomp.sim_bench.studies.real import InjectedSpec
    from fricomp.sim_bench.studies.real import inject as inject_effect
    from fricomp.whole_file import write_whole

    spec = InjectedSpec(source, effect, strength if effect else "", seed)
    with _claim_case(out, INJECTED_CASE, spec.name, overwrite=overwrite) as answers:
        made = inject_effect(spec)
        folder = out / spec.name
        for name, content in made.files.items():
            write_whole(folder / name, content)
        truth = answers / f"{spec.name}.json"
        write_whole(truth, made.answer)
    enr = json.loads(made.answer)["enr"]
    answer({"case": folder, "answer": truth, "enr": enr})
    show = console()
    show.print(f"{folder}: strength {enr:.3g}", soft_wrap=True)
    show.print(f"answer {truth}", soft_wrap=True)
    show.print(f"try: fricomp diagnose {folder} --out {out / 'diagnosis'}", soft_wrap=True)


@contextmanager
def _claim_case(out: Path, kind: Results, name: str, *, overwrite: bool) -> Iterator[Path]:
    """Keep a case and its answer to this process while they are made; gives the folder of the answers, beside `out`.

    Raises:
        DiagnosisError: `out` has no name that the other folder could take.
        OutputError: They are there, and are not to be replaced, or another process makes them.
    """
    from fricomp.errors import DiagnosisError
    from fricomp.results import claim_folder, claim_single_files

    if out.name in ("", ".."):
        raise DiagnosisError(f"--out {out} has no name: the answers go into NAME.answers beside it; give it a folder")
    answers = out.with_name(out.name + ".answers")
    with claim_folder(out / name, kind, overwrite=overwrite) as claim:
        files = [answers / f"{name}.{ending}" for ending in ("json", "parquet")]
        with claim_single_files(files, overwrite=overwrite or claim.is_repeated):
            claim.clear()
            yield answers


@app.command("list", epilog="fricomp cases list")
def list_names() -> None:
    """List effects with their forms, motions, noises, cores, strengths and faults."""
    from fricomp.cli.terminal import Table, console
    from fricomp.sim_bench.cases import CHOICES, EFFECTS

    effects = {each.name: {"kind": each.kind, "forms": [form.name for form in each.forms]} for each in EFFECTS.values()}
    answer({"effects": effects, **CHOICES})
    table = Table("effect", "kind", "forms")
    for effect in EFFECTS.values():
        table.add_row(effect.name, effect.kind, ", ".join(form.name for form in effect.forms))
    from fricomp.sim_bench.cases.arm import ARM_EFFECTS, JOINTS

    show = console()
    show.print(table)
    show.print(f"--arm: joints {', '.join(JOINTS)}; effects {', '.join(ARM_EFFECTS)}", soft_wrap=True)
    for option, names in CHOICES.items():
        show.print(f"--{option}: {', '.join(names)}", soft_wrap=True)
