"""The page on the second generator, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fricomp.report import format_markdown_table

from .effects import EFFECTS
from .figures import compute_figures
from .score import KnownValue, Score

__all__ = ["write_page"]

_INTRODUCTION = """# Joints of a second generator

The [proof](proof.md) makes its joints with a generator of this project. Here MuJoCo makes them: another
implementation of the dynamics, whose integrator and constraints nobody here wrote. What a joint has and its simulation
lacks is a part of MuJoCo (stiffness of the joint, polynomial damping, a range, gear, force range and activation of the
motor, armature, a second hinge, a tendon, a child body), or is written into `dof_frictionloss`, `dof_damping`,
`actuator_gainprm` or `qfrc_applied` before every step, as a function of load, position, direction, speed, temperature
or rest. Neither generator nor diagnosis is imported for it; a test walks the imports.

Every joint is one link of 4 kg in the vertical plane with a Stribeck curve (2 N·m sliding, 2.5 N·m static, 1.2
N·m·s/rad), stepped at 4 kHz with friction loss that truly sticks (`solreffriction="0.002 1"`,
`solimpfriction="0.9999 0.9999 0.001 0.5 2"`). The recording is a most ordinary one: SECONDS s at 1 kHz under a PD loop,
an 18-bit encoder, the loop's velocity (differences of the encoder through a low pass; 2.8 ms late in all), the
commanded torque with 0.04 N·m of white noise, and the temperature of the joint. Each command is held for a sample, so
that every torque acts half a sample late. The simulation is the ordinary MJCF of the plain joint. The motions are slow
ramps with rests and then a multisine (`rich`), and eight harmonics (`fourier`).

What differs from the proof, and makes this weaker evidence:

- Nothing is sealed. The seeds are fixed, and whoever changes the diagnosis can run it on these very cases.
- The cases were made after the diagnosis was written, by the same project.
- Their parameters were chosen by hand, one strength each that is clear, and not by an effect-to-noise ratio.
- Most effects have the form that the catalogue of the diagnosis gives them.
- One joint, one loop and one noise stand behind all of them.
- What intervals allow for the form of a law was set by what these joints showed as well: 80 % held before, so that
  how many hold now says nothing about others.
- The tests of the diagnosis hold joints with MuJoCo's friction loss, too, alone, with cogging and with friction
  under load.

As in the proof, each case is diagnosed in another process, from the files of its recording and simulation alone.
"""
_SCORING = """The filter of the recorded velocity is a flaw of each recording that has that column, so that its name is
right there, and turns `consistent` and `parameters` into `measurement`. A name is right, too, where the right one is
printed as what it cannot be told from. An answer is wrong that has another verdict, a name that is not right, or
another name first than a right one. Parameters that are named though the simulation has them right count as false
names here, as in the proof; the figures stand for the count without them as well. `torque_offset` and
`direction_asymmetry` are a mismatch because the simulation has a friction loss, which is the same both ways; beside
one without friction they are part of what is identified. Intervals of shares are exact 95 %
intervals, the parameters of one case a cluster.
"""


def write_page(scores: Sequence[Score], page: Path, *, quick: bool = False) -> None:
    """Write the Markdown page.

    Args:
        scores: Of the cases.
        page: File.
        quick: The recordings are the short ones.
    """
    sections = [
        _INTRODUCTION.strip().replace("SECONDS", f"{scores[0].case.duration:g}" if scores else "60"),
        f"## Figures\n\n{_title(scores)}\n\n    {_command(page, quick)}\n\n{_figures(scores)}\n\n{_SCORING.strip()}",
        f"## What is missing, and what MuJoCo does\n\n{_effects(scores)}",
        f"## All cases\n\n{_cases(scores)}",
        f"## Known parameters\n\n{_parameters(scores)}",
        f"## Wrong answers\n\n{_wrong(scores, quick)}",
    ]
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n\n".join(sections) + "\n", encoding="utf-8")


def _title(scores: Sequence[Score]) -> str:
    by = " and ".join(sorted({score.diagnosis for score in scores if score.diagnosis}))
    return f"{len(scores)} cases" + (f", by the diagnosis with source hash {by}." if by else ".")


def _command(page: Path, quick: bool) -> str:
    return f"fricomp bench second-generator{' --quick' if quick else ''} --page docs/{page.name} --out runs/second"


def _figures(scores: Sequence[Score]) -> str:
    return format_markdown_table(
        ["figure", "measured (95 % interval)"], [list(figure) for figure in compute_figures(scores)]
    )


def _effects(scores: Sequence[Score]) -> str:
    shown = {score.case.effect for score in scores}
    rows = [[f"`{e.name}`", e.group, e.how] for e in EFFECTS.values() if e.name in shown]
    return format_markdown_table(["missing", "what it is", "what MuJoCo does"], rows)


def _cases(scores: Sequence[Score]) -> str:
    head = ["case", "verdict", "named (cannot be told from)", "right", "error before → after (floor) [N·m]", "seconds"]
    return format_markdown_table(head, [_case(score) for score in scores])


def _case(score: Score) -> list[str]:
    right = "**no**" if score.wrong else "yes"
    named = ", ".join(map(_name, score.named, score.sets)) or "–"
    return [score.case.name, f"`{score.verdict}`", named, right, _errors(score), f"{score.seconds:.0f}"]


def _name(name: str, others: Sequence[str]) -> str:
    return f"`{name}`" + (f" ({', '.join(f'`{other}`' for other in others)})" if others else "")


def _errors(score: Score) -> str:
    if score.before is None or score.after is None or score.floor is None:
        return "–"
    return f"{score.before:.3g} → {score.after:.3g} ({score.floor:.2g})"


def _parameters(scores: Sequence[Score]) -> str:
    rows = [_parameter(score, value) for score in scores for value in score.values if value.effect == score.case.effect]
    head = ["case", "parameter", "true", "found (95 % interval)", "held"]
    return format_markdown_table(head, rows) if rows else "None was found."


def _parameter(score: Score, value: KnownValue) -> list[str]:
    found = f"{value.value:.4g} ({value.low:.4g} to {value.high:.4g})"
    return [score.case.name, value.name, f"{value.truth:.4g}", found, "yes" if value.covered else "**no**"]


def _wrong(scores: Sequence[Score], quick: bool) -> str:
    wrong = [score for score in scores if score.wrong]
    if not wrong:
        return "None."
    rows = [[score.case.name, _why(score), f"`{_again(score, quick)}`"] for score in wrong]
    return f"{len(wrong)} of {len(scores)} answers.\n\n" + format_markdown_table(
        ["case", "what is wrong", "makes it again"], rows
    )


def _why(score: Score) -> str:
    """In words, what is wrong with an answer."""
    if score.error:
        return f"no answer: {score.error.splitlines()[-1].replace('|', '/')}"
    parts = [] if score.verdict_right else [f"`{score.verdict}` in place of `{'` or `'.join(score.expected)}`"]
    if score.false_names:
        parts.append("named " + ", ".join(f"`{name}`" for name in score.false_names))
    if score.hidden and not score.first_right:
        parts.append("not first" if score.found else "not found")
    return "; ".join(parts)


def _again(score: Score, quick: bool) -> str:
    return f"fricomp bench second-generator{' --quick' if quick else ''} --only {score.case.name} --out runs/second"
