"""Numbers in the words of a report, whatever a fit could determine of them."""

import msgspec
import pytest

from fricomp.diagnosis.effects.effect import EffectParameter
from fricomp.diagnosis.record.result import DIAGNOSIS_SCHEMA, DiagnosisRecord, NamedEffect, Quantity
from fricomp.diagnosis.record.sentence import Notes, write_record
from fricomp.diagnosis.report.wording import derive_parameters, format_interval, format_number, format_quantity


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


def test_a_number_at_its_bound_is_said_to_be_there() -> None:
    free = Quantity(0.5, "rad", (0.4, 0.6))
    ended = Quantity(0.5, "rad", (0.4, 0.5), at_bound=True)
    assert format_interval(free) == "0.40 to 0.60"
    assert format_interval(ended) == "0.400 to 0.500, at the bound"
    assert format_interval(Quantity(0.5, "rad", (0.5, 0.5), at_bound=True)) == "at the bound"
    assert format_quantity(ended) == "0.500 ± 0.050 rad, at the bound"
    assert "at the bound" not in format_quantity(free)
    effect = NamedEffect(name="backlash", kind="physics", parameters={"gap": ended}, sentence="a gap")
    fields = DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict="missing_physics", effects=(effect,))
    record = write_record(fields, Notes())
    assert any("gap 0.5 rad (0.4 to 0.5, at the bound)" in sentence for sentence in record.sentences)
    assert msgspec.json.decode(msgspec.json.encode(ended), type=Quantity).at_bound


@pytest.mark.parametrize(("value", "ended"), [(0.0, True), (1e-9, True), (0.3, False), (1.0, True)])
def test_a_number_is_at_its_bound_where_its_domain_ends(value: float, ended: bool) -> None:
    assert EffectParameter("share", "1", 0.1, 0.0, 1.0, linear=False).touches_end(value) is ended
    assert not EffectParameter("sine", "{torque}", 0.1).touches_end(value)


@pytest.mark.parametrize(("order", "ended"), [(4.0, True), (4.003, True), (4.2, False), (100.0, False)])
def test_a_number_that_is_bounded_to_one_side_alone_stands_at_that_bound(order: float, ended: bool) -> None:
    assert EffectParameter("order", "1/{position}", 0.05, 4.0, linear=False).touches_end(order) is ended
