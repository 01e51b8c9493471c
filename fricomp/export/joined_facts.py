"""What the metadata of a graph of several joints say, from those of each joint."""

from collections.abc import Mapping, Sequence

from fricomp.control.compensation.network_file import read_largest_torques, read_loads, read_velocity_range
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.errors import ExportError

_OF_ONE_FILE = ("opset",)


def join_facts(joints: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Metadata of one graph, such that `NetworkCompensator` trusts it no further than the joint that allows least.

    `velocity_range` is what all joints share, and is left out where one states none. `largest_torque` has one number a
    joint, `inf` where it is not known. `status` is the worst, with the `message` of the joints that have it. Anything
    else is kept once where it is the same for all, else for each joint between semicolons.

    Args:
        joints: Metadata of each, in the order of the rows.

    Raises:
        ExportError: Ranges of velocity do not overlap.
        ModelFileError: A file states a range, a load or a largest torque that cannot be meant.
    """
    for about in joints:
        read_largest_torques(about, 1)
        read_loads(about, 1)
    keys = dict.fromkeys(key for about in joints for key in about if key not in _OF_ONE_FILE)
    facts = {key: _join([about.get(key, "") for about in joints]) for key in keys}
    if "joint" in facts:
        facts["joint"] = " ".join(about.get("joint", "") for about in joints)
    if "largest_torque" in facts:
        facts["largest_torque"] = " ".join(about.get("largest_torque", "inf") for about in joints)
    facts.pop("velocity_range", None)
    return facts | _shared_range(joints) | _worst_status(joints)


def _join(values: Sequence[str]) -> str:
    return values[0] if len(set(values)) == 1 else "; ".join(values)


def _shared_range(joints: Sequence[Mapping[str, str]]) -> dict[str, str]:
    if not all("velocity_range" in about for about in joints):
        return {}
    ranges = [read_velocity_range(None, about) for about in joints]
    low, high = max(edges[0] for edges in ranges), min(edges[1] for edges in ranges)
    if not low < high:
        stated = ", ".join(f"{a:g} to {b:g}" for a, b in ranges)
        raise ExportError(f"the joints share no range of velocity ({stated}): export them one by one")
    return {"velocity_range": f"{low:.9g} {high:.9g}"}


def _worst_status(joints: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The status and message of the joints that are usable least; nothing where none has a status."""
    statuses = [about.get("status", "") for about in joints]
    if not any(statuses):
        return {}
    worst = max(statuses, key=_severity)
    messages = [about.get("message", "") for about in joints]
    if len(set(statuses)) == len(set(messages)) == 1:
        return {"status": worst, "message": messages[0]}
    said = zip(joints, statuses, messages, strict=True)
    of_worst = [f"{about.get('joint', '')}: {message}" for about, status, message in said if status == worst]
    return {"status": worst, "message": "; ".join(of_worst)}


def _severity(status: str) -> tuple[bool, bool, bool]:
    """Unusable, else suspect, else unknown, else converged."""
    return find_doubt_in_status(status, "") is not None, status not in ("", "converged"), status == ""
