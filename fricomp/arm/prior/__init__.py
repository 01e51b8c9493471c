"""How far the simulation of an arm, and the friction of its joints, are trusted before anything was recorded."""

from .arm_prior import ArmPrior

__all__ = ["ArmPrior"]
