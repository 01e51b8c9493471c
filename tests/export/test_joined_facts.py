"""What a graph of several joints says of itself, from what each of them says."""

import pytest

from fricomp.control.compensation.network_file import Loads, read_loads
from fricomp.errors import ModelFileError
from fricomp.export.joined_facts import join_facts

_SOUND = {"velocity_range": "-3 3", "largest_torque": "2.5"}


def test_ranges_are_shared_and_torques_kept_for_each() -> None:
    loaded = {"velocity_range": "-2 4", "largest_torque": "1", "normal_load_range": "20 80"}
    facts = join_facts([_SOUND, loaded])
    assert facts["velocity_range"] == "-2 3"
    assert facts["largest_torque"] == "2.5 1"
    assert read_loads(facts, 2) == [Loads(), Loads(20.0, 80.0, 50.0)]


@pytest.mark.parametrize(
    "wrong",
    [
        {"velocity_range": "nan nan"},
        {"velocity_range": "a b"},
        {"largest_torque": "inf"},
        {"largest_torque": ""},
        {"normal_load_range": "80 20"},
    ],
)
def test_what_is_refused_alone_is_refused_among_others(wrong: dict[str, str]) -> None:
    with pytest.raises(ModelFileError):
        join_facts([_SOUND, _SOUND | wrong])
