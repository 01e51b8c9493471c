"""Identification of thousands of joints in one call, on the processor or on a graphics card."""

from .identification import BatchIdentification, identify_batch

__all__ = ["BatchIdentification", "identify_batch"]
