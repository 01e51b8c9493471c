"""A link that alone is heavier all over is named with its factor; where several are off, none is."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import count
from pathlib import Path

import pytest

from fricomp.arm import examine_arm

from .moving_arm import record_arm, write_arm


def write_denser(folder: Path, factors: Sequence[float]) -> Path:
    """The arm whose links weigh so many times as much all over; the finger is part of the last one."""
    numbers, each = count(), [*factors, factors[-1]]

    def scale(match: re.Match[str]) -> str:
        factor = each[next(numbers)]
        inertia = " ".join(str(factor * float(one)) for one in match[2].split())
        return f'mass="{factor * float(match[1])}" diaginertia="{inertia}"'

    text = re.sub(r'mass="([^"]*)" diaginertia="([^"]*)"', scale, write_arm(folder).read_text())
    path = folder / "denser.xml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("link", "factor"), [(1, 1.15), (2, 0.85)])
def test_a_link_that_is_denser_is_named_with_its_factor(tmp_path: Path, link: int, factor: float) -> None:
    factors = [factor if i == link else 1.0 for i in range(3)]
    record = examine_arm(record_arm(write_denser(tmp_path, factors)), write_arm(tmp_path)).record
    found = record.lone_link
    assert found is not None
    assert found.name == record.links[link].name
    assert found.factor.ci95[0] < factor < found.factor.ci95[1]
    assert found.factor.value == pytest.approx(factor, abs=0.03)
    assert any(f"{found.name}, if all of it weighs" in one for one in record.summary)


@pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0), (1.1, 0.9, 1.15)])
def test_no_link_is_alone_where_none_is_off_or_several_are(tmp_path: Path, factors: tuple[float, ...]) -> None:
    record = examine_arm(record_arm(write_denser(tmp_path, factors)), write_arm(tmp_path)).record
    assert record.lone_link is None
