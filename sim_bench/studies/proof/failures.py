"""The list of wrong answers as text, for whoever works on the diagnosis."""

from __future__ import annotations

from collections.abc import Sequence

from .judging import is_wrong
from .score import Score

__all__ = ["format_failures"]


def format_failures(scores: Sequence[Score]) -> str:
    """Wrong answers, those with nothing concealed first, each with the command that makes its case."""
    wrong = sorted((score for score in scores if is_wrong(score)), key=lambda s: (s.group, s.truth, -s.enr))
    lines = [f"# {len(wrong)} wrong answers of {len(scores)}", ""]
    for score in wrong:
        hidden = f"{score.truth or 'nothing'} ({score.forms})" if score.truth else "nothing"
        sets = f", cannot be told from {score.sets}" if score.sets.strip("+|") else ""
        setting = f"{score.excitation}, {score.core}, {score.noise}"
        residual = f"residual over noise {score.noise_ratio:.2f}, {score.seconds:.0f} s"
        error = f"; {score.error.splitlines()[-1]}" if score.error else ""
        lines += [
            f"- [{score.group}] concealed {hidden}, ENR {score.enr:.2f}, {setting}",
            f"  answered {score.verdict}: {score.named or 'no name'}{sets}; {residual}{error}",
            f"  {score.command}",
        ]
    return "\n".join(lines) + "\n"
