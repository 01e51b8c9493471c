"""Calibration: sweep a joint, identify its friction, design the next sweep."""

from .identification import IdentificationOptions, IdentificationResult, choose_law, identify, identify_dynamic

__all__ = ["IdentificationOptions", "IdentificationResult", "choose_law", "identify", "identify_dynamic"]
