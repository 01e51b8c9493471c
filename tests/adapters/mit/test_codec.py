"""The MIT frame, against codes worked out by hand for the ranges of a DM-J4310: 12.5 rad, 30 rad/s, 10 N·m."""

from math import inf, nan
from typing import Any

import pytest

from fricomp.adapters.mit.codec import MitCodec, MitRanges, saturate, to_code
from fricomp.errors import AdapterConfigurationError, AdapterValueError

RANGES = MitRanges(position=12.5, velocity=30.0, torque=10.0)
CODEC = MitCodec(RANGES)


@pytest.mark.parametrize(
    ("command", "sent"),
    [
        ((0.0, 0.0, 0.0, 0.0, 0.0), "8000 800 000 000 800"),
        ((-12.5, -30.0, 0.0, 0.0, -10.0), "0000 000 000 000 000"),
        ((12.5, 30.0, 500.0, 5.0, 10.0), "ffff fff fff fff fff"),
        ((99.0, 99.0, 999.0, 99.0, 99.0), "ffff fff fff fff fff"),
        ((-99.0, -99.0, -9.0, -9.0, -99.0), "0000 000 000 000 000"),
        ((-12.5 + 25.0 * 0x1234 / 65535, 30.0 * (2 * 0x567 / 4095 - 1), 500.0 * 0x89A / 4095, 5.0 * 0xBCD / 4095,
          10.0 * (2 * 0xEF0 / 4095 - 1)), "1234 567 89a bcd ef0"),
    ],
)  # fmt: skip
def test_a_command_is_five_codes_in_a_row(command: tuple[float, ...], sent: str) -> None:
    assert CODEC.encode(*command).hex() == sent.replace(" ", "")


@pytest.mark.parametrize("torque", [0.0, 1.0, -3.3, 10.0, -10.0, 11.0, -99.0])
def test_torque_alone_is_the_command_without_gains(torque: float) -> None:
    assert CODEC.encode_torque(torque) == CODEC.encode(0.0, 0.0, 0.0, 0.0, torque)


@pytest.mark.parametrize("torque", [nan, inf, -inf])
def test_no_code_stands_for_what_is_not_finite(torque: float) -> None:
    for encode in (
        CODEC.encode_torque,
        lambda bad: CODEC.encode(bad, 0.0, 0.0, 0.0, 0.0),
        lambda bad: saturate(bad, 1.0),
    ):
        with pytest.raises(AdapterValueError, match="cannot be sent"):
            encode(torque)


@pytest.mark.parametrize(
    ("answer", "state"),
    [
        ("0000 000 000", (-12.5, -30.0, -10.0)),
        ("ffff fff fff", (12.5, 30.0, 10.0)),
        ("0001 002 003", (-12.5 + 25.0 / 65535, -30.0 + 120.0 / 4095, -10.0 + 60.0 / 4095)),
        ("8000 fff 000", (12.5 / 65535, 30.0, -10.0)),
    ],
)
def test_a_state_is_three_codes_in_a_row(answer: str, state: tuple[float, float, float]) -> None:
    assert CODEC.decode(bytes.fromhex(answer.replace(" ", ""))) == pytest.approx(state, rel=1e-12)


def test_a_quantum_is_the_step_from_code_to_code() -> None:
    assert CODEC.position_quantum == pytest.approx(25.0 / 65535)
    assert CODEC.velocity_quantum == pytest.approx(60.0 / 4095)
    assert CODEC.torque_quantum == pytest.approx(20.0 / 4095)


def test_a_value_gets_the_nearest_code_or_the_one_at_the_edge() -> None:
    assert [to_code(value, -1.0, 3.0, 4) for value in (-9.0, -1.0, -0.6, -0.4, 2.4, 2.6, 3.0, 9.0)] == [
        0, 0, 0, 1, 3, 4, 4, 4,
    ]  # fmt: skip
    assert [saturate(value, 2.0) for value in (-3.0, -2.0, 0.5, 2.0, 3.0)] == [-2.0, -2.0, 0.5, 2.0, 2.0]


@pytest.mark.parametrize("name", ["position", "velocity", "torque", "kp", "kd"])
@pytest.mark.parametrize("bad", [0.0, -1.0, nan, inf])
def test_ranges_are_finite_and_positive(name: str, bad: float) -> None:
    given: dict[str, Any] = {"position": 1.0, "velocity": 1.0, "torque": 1.0, name: bad}
    with pytest.raises(AdapterConfigurationError, match=f"the {name} range"):
        MitRanges(**given)
