"""A motor's encoder alone, in a proposed mapping: it is brought to the joint by the gear, which the log may state."""

from pathlib import Path

from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.head_fact import read_head_facts


def is_motors(position: str) -> bool:
    """Whether the column that stands for the position is called as that of a motor."""
    meaning = read_column_name(position)
    return meaning is not None and meaning.channel == "motor_position"


def bring_rule_to_joint(path: Path, rule: str) -> str:
    """The rule of a position or a velocity over the gear ratio: the stated one, or with a word that asks for it.

    Args:
        path: The log.
        rule: A line of a mapping.
    """
    if "scale = " in rule or not rule.endswith(" }"):
        return rule
    fact = read_head_facts(path).get("RATIO")
    if fact is None:
        return f"{rule.removesuffix(' }')}, scale = 1/RATIO }}  # RATIO turns of the motor are one of the joint"
    return f"{rule.removesuffix(' }')}, scale = {1.0 / fact.value:.9g} }}  # by {fact.said!r}"


def remark_on_torque(path: Path, rule: str) -> str:
    """The rule of a torque with a remark on the gear, where it may be that of the motor.

    Args:
        path: The log.
        rule: A line of a mapping.
    """
    if "#" in rule:
        return rule
    fact = read_head_facts(path).get("RATIO")
    ratio = "RATIO" if fact is None else f"{fact.value:.6g}"
    return f"{rule}  # scale = {ratio} beside it where it is a motor's torque in N·m; a current stays as it is"
