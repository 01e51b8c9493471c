"""An identification as files: `friction.json` and `friction.onnx`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

from fricomp.model import save_model

from ..network import save_network
from .result import IdentificationResult

__all__ = ["ModelFiles", "save_identification"]


class ModelFiles(NamedTuple):
    """Where an identification was written.

    Attributes:
        model: The closed form, JSON.
        network: The network, ONNX.
        model_sha256: Hash of the JSON file, which the network's metadata repeats.
    """

    model: Path
    network: Path
    model_sha256: str


def save_identification(result: IdentificationResult, folder: str | os.PathLike[str]) -> ModelFiles:
    """Write the closed form and the network that agrees with it.

    Raises:
        ModelFileError: The model cannot be written.
        ExportError: The network cannot be written.
    """
    files = Path(folder) / "friction.json", Path(folder) / "friction.onnx"
    digest = save_model(result.model, files[0])
    model, distillation = result.model, result.distillation
    validity = model.validity
    metadata = {
        "input": f"velocity [{model.position_unit}/s], normal_load (load at {distillation.network.load_offset:g} "
        "where it is not known)",
        "output": f"friction torque [{model.torque_unit}]",
        "joint": model.joint,
        "velocity_range": " ".join(f"{v:.9g}" for v in validity.velocity or ()),
        "normal_load_range": " ".join(f"{v:.9g}" for v in validity.normal_load or ()),
        "model_json_sha256": digest,
        "largest_deviation_from_model": f"{distillation.largest_error:.3g} of the largest torque",
        "trained_on": "the closed form, by collocation",
    }
    save_network(distillation.network, files[1], metadata)
    return ModelFiles(*files, digest)
