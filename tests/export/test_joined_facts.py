"""What a graph of several joints says of itself, from what each of them says."""

import pytest

from fricomp.errors import ModelFileError
from fricomp.export.joined_facts import join_facts

_SOUND = {"velocity_range": "-3 3", "largest_torque": "2.5"}


def test_ranges_are_shared_and_torques_kept_for_each() -> None:
    facts = join_facts([_SOUND, {"velocity_range": "-2 4", "largest_torque": "1"}])
    assert facts["velocity_range"] == "-2 3"
    assert facts["largest_torque"] == "2.5 1"


@pytest.mark.parametrize(
    "wrong",
    [{"velocity_range": "nan nan"}, {"velocity_range": "a b"}, {"largest_torque": "inf"}, {"largest_torque": ""}],
)
def test_what_is_refused_alone_is_refused_among_others(wrong: dict[str, str]) -> None:
    with pytest.raises(ModelFileError):
        join_facts([_SOUND, _SOUND | wrong])
