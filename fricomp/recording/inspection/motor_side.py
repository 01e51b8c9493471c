"""A motor's encoder alone, in a proposed mapping: it is brought to the joint by the gear, which the log may state."""

import re
from pathlib import Path

from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.head_fact import HeadFact, read_head_facts
from fricomp.recording.unit import find_unit

_SCALE = re.compile(r", scale = ([^,}]+?)(?= \}|,)")
_NUMBER = re.compile(r"[\d.]+(?:e[+-]?\d+)?")
_UNIT = re.compile(r', unit = "([^"]*)"')
"""What a rule says of the size of its column's numbers."""


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
    fact = read_head_facts(path).get("RATIO")
    by = "RATIO turns of the motor are one of the joint" if fact is None else f"by {fact.said!r}"
    said = _SCALE.search(rule)
    if said is None:
        if not rule.endswith(" }"):
            return rule
        scale = "1/RATIO" if fact is None else f"{1.0 / fact.value:.9g}"
        return f"{rule.removesuffix(' }')}, scale = {scale} }}  # {by}"
    scale = said.group(1)
    if scale == "VALUE_OF_ONE":
        return rule
    if scale == "6.2832/COUNTS_A_TURN":
        scale = f"6.2832/(COUNTS_A_TURN*{'RATIO' if fact is None else f'{fact.value:.9g}'})"
    elif fact is not None and _NUMBER.fullmatch(scale):
        scale = f"{float(scale) / fact.value:.9g}"
    else:
        scale = f"{scale}/RATIO"
    return f"{rule[: said.start(1)]}{scale}{rule[said.end(1) :]}{'; ' if '#' in rule else '  # '}{by}"


def remark_on_torque(path: Path, rule: str, column: str) -> str:
    """The rule of a torque with a remark on the gear, where it may be that of the motor.

    Args:
        path: The log.
        rule: A line of a mapping.
        column: Of the torque.
    """
    if "#" in rule:
        return rule
    facts, meaning = read_head_facts(path), read_column_name(column)
    fact, constant = facts.get("RATIO"), facts.get("KT")
    is_current = meaning is not None and meaning.channel == "current"
    step, unit = _SCALE.search(rule), _UNIT.search(rule)
    is_known = step is None or _NUMBER.fullmatch(step.group(1)) is not None  # and no part of a rating to be said
    if constant is not None and is_current and rule.endswith(" }") and is_known:
        one = (float(step.group(1)) if step else 1.0) * find_unit(unit.group(1) if unit else "A").factor
        said, scale = name_joint_scale(constant.value * one, constant, fact)
        bare = _UNIT.sub("", _SCALE.sub("", rule)).removesuffix(" }")
        return f'{rule}\n# {bare}, scale = {scale} }}  # in place of it, with torque_unit = "N·m": {said}'
    ratio = "RATIO" if fact is None else f"{fact.value:.6g}"
    return f"{rule}  # scale = {ratio} beside it where it is a motor's torque in N·m; a current stays as it is"


def name_joint_scale(worth: float, constant: HeadFact, ratio: HeadFact | None) -> tuple[str, str]:
    """Why, and by what a motor's current is multiplied for the torque of the joint in N·m, as a mapping has it.

    Args:
        worth: Torque of the motor at one of the current's numbers [N·m].
        constant: The torque constant as the log states it.
        ratio: The gear ratio likewise; None where it does not.
    """
    if ratio is None:
        return f"times the gear ratio, by {constant.said!r}", f"{worth:.6g}"
    return f"by {constant.said!r} and {ratio.said!r}; {worth:.6g} without a gear", f"{worth * ratio.value:.6g}"
