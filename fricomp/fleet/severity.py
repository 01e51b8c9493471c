"""How bad a joint's answer is: what a fleet's list begins with, and what a command may fail on."""

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

from fricomp.control.compensation.trust import find_doubt_in_status


class Severity(IntEnum):
    """The worst is the largest."""

    FINE = 0
    """A usable model; a simulation that misses nothing."""
    PARAMETERS = 1
    """Only numbers or the measurement are off."""
    MISSING = 2
    """Physics is missing, known or unknown."""
    UNUSABLE = 3
    """It failed, its data cannot be diagnosed, or its model is not usable."""


def rate_row(row: Mapping[str, Any]) -> Severity:
    """How bad the answer in a row of a fleet is."""
    verdict, status = row.get("verdict"), row.get("status")
    doubted = status is not None and find_doubt_in_status(str(status), "") is not None
    if row["error"] or doubted or verdict == "bad_data":
        return Severity.UNUSABLE
    if verdict in ("missing_physics", "unknown_physics"):
        return Severity.MISSING
    return Severity.FINE if verdict in (None, "consistent") else Severity.PARAMETERS
