"""One thing a check found in a recording: where it is and what to do about it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from fricomp.errors import RecordingError

Severity = Literal["error", "warning", "note"]


class RecordingWarning(UserWarning):
    """A recording was read, but something about its file is not as it should be."""


@dataclass(frozen=True)
class Finding:
    """One observation about a recording.

    Attributes:
        code: Short stable name of the check, e.g. "degrees" or "gap".
        severity: "error" (cannot be used), "warning" (may mislead) or "note".
        message: What was found, with value and limit.
        advice: What to do about it.
        row: First data row concerned, counted from 1; None where the whole recording is.
        column: Channel concerned; None where all are.
    """

    code: str
    severity: Severity
    message: str
    advice: str
    row: int | None = None
    column: str | None = None

    @property
    def caution(self) -> str:
        """A sentence to stand beside a result."""
        return f"Careful: {self.message.rstrip('.')}: {self.advice}."

    def __str__(self) -> str:
        where = [f"row {self.row}"] if self.row is not None else []
        where += [f"column {self.column}"] if self.column is not None else []
        return f"{', '.join(where)}{': ' if where else ''}{self.message}; {self.advice}"


def raise_errors(findings: Sequence[Finding], subject: str) -> None:
    """Raise the errors among the findings as one sentence; return when there are none.

    Raises:
        RecordingError: At least one finding is an error.
    """
    errors = [finding for finding in findings if finding.severity == "error"]
    if errors:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        begun = "in a mapping" in errors[0].advice and "--inspect" not in errors[0].advice
        begin = "; 'fricomp convert LOG --inspect --out log.toml' begins one" if begun else ""
        raise RecordingError(f"{subject}: {errors[0]}{more}{begin}")
