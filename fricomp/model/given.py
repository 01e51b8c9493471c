"""What a caller gives as a model: one, what an identification or a diagnosis gave, or where it lies."""

from __future__ import annotations

import os
from pathlib import Path

from fricomp.errors import ParameterError

from .model import FrictionModel

_OF_RESULTS = ("model", "extended_model", "base_model")
"""Attributes under which results hold their model, the best one first."""


def take_model(given: object) -> FrictionModel | Path:
    """The model that was given, or the path of its file or folder.

    Args:
        given: A model, the result of an identification, calibration or diagnosis, or a path.

    Raises:
        ParameterError: It is something else.
    """
    if isinstance(given, str | os.PathLike):
        return Path(given)
    held = [given, *(getattr(given, name, None) for name in _OF_RESULTS)]
    found = next((one for one in held if isinstance(one, FrictionModel)), None)
    if found is None:
        raise ParameterError(
            f"{type(given).__name__} is no friction model: give a FrictionModel, what identify or diagnose gave, or "
            "the path of a friction.json"
        )
    return found
