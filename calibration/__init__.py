"""Calibration: sweep a joint, identify its friction, design the next sweep."""

from .identification import IdentificationOptions, IdentificationResult, identify

__all__ = ["IdentificationOptions", "IdentificationResult", "identify"]
