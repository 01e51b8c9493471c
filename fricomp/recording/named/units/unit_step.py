"""Units with a number before them, of which whole numbers are so many: `current (0.01 A)`, `pos [1/1000 deg]`."""

import re
from typing import NamedTuple

from fricomp.recording.unit_word import make_narrow, read_unit

_COUNTED = re.compile(
    r"[\[(]\s*[x×]?\s*(1\s*/\s*\d+|10\^?[-−]\d+|\d*[.,]?\d+(?:[eE][+-]?\d+)?)\s*[x×*]?\s*"
    r"([^\d\s\[\]()][^\[\]()]*)[\])]"
)
"""A unit with a number before it in brackets."""
_SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_POWER = re.compile(r"10\^?[-−](\d+)")


class UnitStep(NamedTuple):
    """What one of whole numbers is worth.

    Attributes:
        unit: Its name.
        worth: So many of it.
    """

    unit: str
    worth: float


def find_unit_step(name: str) -> UnitStep | None:
    """The unit with a number before it that stands in brackets, `(0.1 Nm)`, `[0.01A]`; None where none does.

    Args:
        name: Of a column.
    """
    found = _COUNTED.search(make_narrow(name).translate(_SUPERSCRIPTS))
    unit = read_unit(found.group(2)) if found else ""
    return UnitStep(unit, _read_worth(found.group(1))) if found and unit else None


def _read_worth(text: str) -> float:
    """A number before a unit: `0.01`, `1/1000`, `10^-3`."""
    over, power = text.partition("/")[2], _POWER.fullmatch(text)
    if over:
        return 1.0 / float(over)
    return 10.0 ** -int(power.group(1)) if power else float(text.replace(",", "."))
