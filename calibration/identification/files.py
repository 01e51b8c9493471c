"""An identification as files: `friction.json`, `friction.onnx`, and the network that departs from the law."""

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fricomp.model import save_model

from ..network import TanhNetwork, save_network
from .discrepancy import DiscrepancyNetwork
from .result import IdentificationResult

__all__ = ["ModelFiles", "save_discrepancy", "save_identification"]


DEPARTED = "friction_departed.onnx"
"""File of the network that departs from the law."""


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
    """Write the closed form and the network that agrees with it; one that departed from an earlier model there goes.

    Raises:
        ModelFileError: The model cannot be written.
        ExportError: The network cannot be written.
    """
    files = Path(folder) / "friction.json", Path(folder) / "friction.onnx"
    digest = save_model(result.model, files[0])
    (Path(folder) / DEPARTED).unlink(missing_ok=True)
    about = {
        "largest_deviation_from_model": f"{result.distillation.largest_error:.3g} of the largest torque",
        "trained_on": "the closed form, by collocation",
    }
    save_network(result.network, files[1], _collect_metadata(result, result.network, digest) | about)
    return ModelFiles(*files, digest)


def save_discrepancy(
    found: DiscrepancyNetwork, result: IdentificationResult, folder: str | os.PathLike[str], model_sha256: str
) -> Path:
    """Write the network that departs from the closed form as `DEPARTED`.

    Args:
        found: The network.
        result: The identification that it departs from.
        folder: Where to write.
        model_sha256: Hash of that identification's JSON file.

    Raises:
        ExportError: The network cannot be written.
    """
    path = Path(folder) / DEPARTED
    about = {
        "trained_on": f"the data, and the closed form with weight {found.weight:g}",
        "held_out_error": f"{found.held_out[found.weight]:.3g} noise deviations",
        "held_out_error_of_model": f"{found.held_out[np.inf]:.3g} noise deviations",
    }
    save_network(found.network, path, _collect_metadata(result, found.network, model_sha256) | about)
    return path


def _collect_metadata(result: IdentificationResult, network: TanhNetwork, digest: str) -> dict[str, str]:
    model, validity = result.model, result.model.validity
    return {
        "input": f"velocity [{model.position_unit}/s], normal_load (load at {network.load_offset:g} "
        "where it is not known)",
        "output": f"friction torque [{model.torque_unit}]",
        "joint": model.joint,
        "velocity_range": " ".join(f"{v:.9g}" for v in validity.velocity or ()),
        "normal_load_range": " ".join(f"{v:.9g}" for v in validity.normal_load or ()),
        "model_json_sha256": digest,
        "status": str(result.status),
        "message": result.message,
        "largest_torque": f"{model.provenance.largest_torque:.9g}",
    }
