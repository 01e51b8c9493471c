"""Calibration: sweep a joint, identify its friction, design the next sweep."""

if __name__ == "calibration":
    raise ImportError(
        "calibration is a part of fricomp, with other classes under this name: import fricomp.calibration"
    )

from .identification import IdentificationOptions, IdentificationResult, choose_law, identify, identify_dynamic

__all__ = ["IdentificationOptions", "IdentificationResult", "choose_law", "identify", "identify_dynamic"]
