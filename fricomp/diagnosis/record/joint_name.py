"""What a joint is called."""

from __future__ import annotations


def call_joint(name: str, word: str = "joint") -> str:
    """The joint in a sentence or a title: by its name, with a word before it that the name does not have."""
    return name if "joint" in name.lower() else f"{word} {name}"
