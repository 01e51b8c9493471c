"""The page of a proof: figures, power, confusion and wrong answers as Markdown with charts beside it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from fricomp.report import Chart, HeatMap, Line, Panel, Points, draw_png

from .plan import NULLS
from .score import Score
from .summary import Figure, PowerPoint, compute_confusion, compute_figures, compute_power, is_wrong

__all__ = ["write_page"]

_MARK = {True: "yes", False: "**no**", None: "no target"}
_NO_CASE = "–"  # begins the value of a figure without one
_INTRODUCTION = """# Proof on concealed cases

`fricomp bench mismatch` makes joints with physics that their simulation leaves out, has `fricomp diagnose` look at
recording, simulation and controller only, and compares. The generator (`sim_bench/concealed`) steps its own closed-loop
dynamics at 20 kHz, with friction cores, effects and sensors of its own, and imports neither the friction laws nor the
diagnosis; a test walks the imports.

Strength is the effect-to-noise ratio (ENR): the RMS of what a refit of everything the simulation already has leaves
of the concealed torque, over the noise, in 42 ms windows on noise-free data. The hash of each answer with its salt is
written to disk before the diagnosis of that case starts in another process and an empty folder. **That proves the
order of events, not independence**: generator and diagnosis come from one project. Scored seeds follow from the hash
of the committed diagnosis folder and the number of the run, so that they cannot be known while it is written; every
scored run is logged in `docs/proof/runs.jsonl` before it starts, so that abandoned ones show too.

The oracle beside the power is the likelihood-ratio test that knows every effect's shape, at the same ENR and length and
2 % false alarms over all effects together, with every other of the overlapping windows counted as independent.

A run goes in pieces: `--minutes M` starts no case after M minutes, finishes those under way and writes the page,
`--resume` goes on, in another checkout from the data beside this page. Groups, effects and strengths are interleaved,
so that any beginning is a fair sample of the whole; every scored run has an order of its own. Up to the 25th, every
effect met one friction core only, as lists turned side by side. A scored run refuses to go on with another diagnosis
than the one it began with.
`--nulls` runs joints with nothing missing alone ([300 of them](nulls.md)), `--baselines N` compares
other methods on the first N cases, `--speed-up N` times N cases with one worker and with two, and
[executors](fleet.md) are those of fleets.
"""
_INJECTED = """# Effects injected into real recordings

`fricomp bench mismatch --injected` adds the torque that a known effect would have cost along the measured motion to
the torque channel of public recordings, and has `fricomp diagnose` look at the result blind, sealed as on simulated
joints. The noise, the friction and the flaws are those of real joints; the loop has not reacted to the effect.

Strength is what a refit of a rigid joint with a Stribeck curve for each direction leaves of the effect in 42 ms
windows, over what the same refit leaves of the recording itself. Before that the recordings are diagnosed as they are:
what is named there counts as known, is not injected, and is no false name afterwards. Recordings that come out
complete as they are stand apart from those in which more is missing already.
"""
_NULLS = """# False alarms on joints with nothing missing

`fricomp bench mismatch --nulls` makes joints of which the simulation leaves nothing out, some of them with inertia,
gravity and friction other than the simulation says, and has `fricomp diagnose` look at them blind. Generator, sealing
and what is not proved are those of the [proof on concealed cases](proof.md).
"""
_LIMITS = """## What is not proved here

- Generator and diagnosis come from one project; effects that neither of them thinks of are not tried, beyond those
  outside the catalogue. Joints whose dynamics and left-out physics are MuJoCo's have
  [a page of their own](second_generator.md); they are not sealed.
- The joints are simulated, one hinge each. Effects injected into real recordings, with real noise, have
  [a page of their own](injected.md).
- Motion of a neighbouring joint is not logged, so that `neighbour_coupling` counts as right when it is called unknown
  or external.
- Strength of `presliding_hysteresis` is measured against the stiff bristle of the same joint; a diagnosis that fits
  the bristle's stiffness sees less of it.
- How much of the held-out gap is closed, of what the right structure could close, is not known for scored cases: the
  figure above counts from the diagnosis' own estimate of the noise, which is never above the error that its answer
  leaves, so that it is near 1 by construction and cannot be compared with the target of 0.95. What could be reached
  takes a second diagnosis without the concealed torque: `--gap N` does that on N cases of development seeds.
"""
_LONGEST = 60  # wrong answers in the page; all are in the data


def write_page(
    scores: Sequence[Score],
    page: Path,
    *,
    title: str,
    reproduce: str,
    baselines: str = "",
    earlier: str = "",
    gaps: str = "",
) -> None:
    """Write `page` and the charts in the folder of its name beside it.

    Args:
        scores: Of the cases.
        page: Markdown file.
        title: Which run this is, in one sentence.
        reproduce: Command that makes it again.
        baselines: Markdown of the comparison with other methods; empty for none.
        earlier: Markdown of the scored runs before this one; empty for none.
        gaps: Markdown of the gaps closed, measured by second diagnoses; empty for none.
    """
    groups = {score.group for score in scores}
    injected, only_nulls = any(group.startswith("injected") for group in groups), groups <= set(NULLS)
    charts = page.with_suffix("")
    charts.mkdir(parents=True, exist_ok=True)
    figures, power, confusion = compute_figures(scores), compute_power(scores), compute_confusion(scores)
    sections = [
        _INJECTED if injected else _NULLS if only_nulls else _INTRODUCTION,
        f"## Figures\n\n{title}\n\n    {reproduce}\n\n{_figure_table(figures)}",
        f"## Cases\n\n{_group_table(scores)}",
    ]
    if power:
        draw_png(_power_chart(power), charts / "power.png")
        link = f"![Power against strength]({charts.name}/power.png)"
        sections.append(f"## Power\n\n{link}\n\n{_power_table(power)}")
    if confusion:
        draw_png(_confusion_chart(confusion), charts / "confusion.png")
        sections.append(f"## Which answer came first\n\n![Confusion matrix]({charts.name}/confusion.png)")
    sections += [part for part in (gaps, earlier, baselines) if part]
    sections += [_answers_as_they_are(scores)] if injected else [] if only_nulls else [_LIMITS]
    sections.append(f"## Wrong answers\n\n{_wrong_table(scores)}")
    page.write_text("\n\n".join(section.strip() for section in sections) + "\n", encoding="utf-8")


def _figure_table(figures: Sequence[Figure]) -> str:
    rows = [
        f"| {f.name} | {f.target} | {f.value} | {_MARK[f.reached]} |"
        for f in figures
        if not f.value.startswith(_NO_CASE)
    ]
    return "\n".join(["| figure | target | measured (95 % interval) | reached |", "|---|---|---|---|", *rows])


def _group_table(scores: Sequence[Score]) -> str:
    groups = Counter(score.group for score in scores)
    wrong = Counter(score.group for score in scores if is_wrong(score))
    rows = [f"| {group} | {count} | {wrong[group]} |" for group, count in groups.most_common()]
    return "\n".join(["| group | cases | wrong answers |", "|---|---|---|", *rows])


def _answers_as_they_are(scores: Sequence[Score]) -> str:
    rows = [f"| {s.excitation} | {s.verdict} | {s.named or '–'} |" for s in scores if s.group == "injected_null"]
    head = ["## The recordings as they are", "", "| recording | verdict | named |", "|---|---|---|"]
    return "\n".join([*head, *rows])


def _power_table(points: Sequence[PowerPoint]) -> str:
    rows = [f"| {p.strength} | {p.enr:.2f} | {p.detected} | {p.named} | {p.oracle:.1%} |" for p in points]
    head = ["| wanted ENR | median ENR | not called consistent | right name first | oracle |", "|---|---|---|---|---|"]
    return "\n".join([*head, *rows])


def _power_chart(points: Sequence[PowerPoint]) -> Chart:
    enr = np.array([point.enr for point in points])
    order = np.argsort(enr)
    marks = [Line(enr[order], np.array([p.oracle for p in points])[order], "likelihood-ratio oracle", stroke="dashed")]
    for name, shares in (("detected", [p.detected for p in points]), ("right name first", [p.named for p in points])):
        half = np.array([0.5 * (s.high - s.low) for s in shares])
        middle = np.array([0.5 * (s.high + s.low) for s in shares])
        marks.append(Line(enr[order], np.array([s.share for s in shares])[order], name))
        marks.append(Points(enr, middle, error=half, size=0.1))  # type: ignore[arg-type]
    panel = Panel(tuple(marks), "effect-to-noise ratio after the base refit", "share of cases", x_scale="log")
    return Chart("power", "Power against strength", (panel,), caption="Bars are exact 95 % intervals.")


def _confusion_chart(table: Mapping[str, Counter[str]]) -> Chart:
    answers = sorted({answer for row in table.values() for answer in row})
    values = np.array([[row[answer] / sum(row.values()) for answer in answers] for row in table.values()])
    values[values == 0.0] = np.nan
    names = tuple(f"{name} ({sum(row.values())})" for name, row in table.items())
    x, y = (np.arange(n, dtype=np.float64) for n in values.shape[::-1])
    heat = HeatMap(x, y, values, "share of cases", x_names=tuple(answers), y_names=names)
    panel = Panel((heat,), "answer", "concealed (cases)")
    return Chart("confusion", "Which answer came first", (panel,), panel_height=200 + 18 * len(names))


def _wrong_table(scores: Sequence[Score]) -> str:
    wrong = [score for score in scores if is_wrong(score)]
    if not wrong:
        return "None."
    rows = [
        f"| {s.truth or 'nothing'} | {s.enr:.2f} | {s.named or s.verdict} | {s.excitation} | `{s.command}` |"
        for s in wrong[:_LONGEST]
    ]
    head = [
        f"{len(wrong)} of {len(scores)} answers: a false name, a miss at ENR 0.5 or more, or no answer"
        + (f"; the first {_LONGEST} are listed, all are in the scores." if len(wrong) > _LONGEST else "."),
        "",
        "| concealed | ENR | answer | motion | makes the case |",
        "|---|---|---|---|---|",
    ]
    return "\n".join([*head, *rows])
