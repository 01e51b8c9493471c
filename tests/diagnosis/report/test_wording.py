"""Numbers in the words of a report, whatever a fit could determine of them."""

import pytest

from fricomp.diagnosis.record.result import NamedEffect, Quantity
from fricomp.diagnosis.report.wording import derive_parameters, format_interval, format_number


@pytest.mark.parametrize(
    ("value", "step", "text"),
    [
        (1.23456, None, "1.235"),
        (1.23456, 0.01, "1.235"),
        (1.23456, float("nan"), "1.235"),
        (1.23456, float("inf"), "1.235"),
        (float("nan"), 0.1, "–"),
        (0.0, 0.5, "0.00"),
    ],
)
def test_a_number_is_written_whatever_its_step(value: float, step: float | None, text: str) -> None:
    assert format_number(value, step) == text


def test_a_period_whose_order_may_be_none_at_all_is_not_determined() -> None:
    order = Quantity(2.8, "1/rad", (-3096.0, 3102.0))
    effect = NamedEffect(name="cogging", kind="physics", parameters={"order": order})
    period = derive_parameters(effect)["period"]
    assert format_interval(period) == "not determined"
    assert format_number(period.value, 0.5 * (period.ci95[1] - period.ci95[0])) == "2.244"
