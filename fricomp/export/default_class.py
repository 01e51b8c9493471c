"""What an MJCF joint takes from its default class."""

import xml.etree.ElementTree as ET


def joint_type(root: ET.Element, joint: ET.Element) -> str | None:
    """The type of `joint`: its own, that of its default class or one around that, or `hinge`.

    None where no such type is stated here and the file includes others, whose classes are not known.

    Args:
        root: The MJCF file.
        joint: An element in it. Its class is the one that it names, or the `childclass` of the nearest element around.
    """
    parents = {child: parent for parent in root.iter() for child in parent}
    chosen, around = joint.get("class"), parents.get(joint)
    while chosen is None and around is not None:
        chosen, around = around.get("childclass"), parents.get(around)
    found, scope = joint.get("type"), _default_class(root, chosen)
    while found is None and scope is not None:
        stated = scope.find("joint")
        found = None if stated is None else stated.get("type")
        scope = parents[scope] if parents[scope].tag == "default" else None
    return found or ("hinge" if root.find(".//include") is None else None)


def _default_class(root: ET.Element, name: str | None) -> ET.Element | None:
    """The `<default>` of that class; the outermost one for None."""
    if name is None:
        return root.find("default")
    return next((each for each in root.iter("default") if each.get("class") == name), root.find("default"))
