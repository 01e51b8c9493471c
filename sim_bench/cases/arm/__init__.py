"""Concealed arms: recordings of six joints that move at once, with links and friction that the simulation lacks.

The arm is the packaged MJCF file with links of its own draw. It is stepped with MuJoCo's mass matrix and bias, and with
friction that is solved for here; neither the friction laws of the library nor the diagnosis is imported.
"""

from .case import ArmCase, generate_arm
from .spec import ARM_EFFECTS, JOINTS, ArmSpec, draw_spec, parse_effect
from .writing import arm_id, write_arm_answer, write_arm_case

__all__ = [
    "ARM_EFFECTS",
    "JOINTS",
    "ArmCase",
    "ArmSpec",
    "arm_id",
    "draw_spec",
    "generate_arm",
    "parse_effect",
    "write_arm_answer",
    "write_arm_case",
]
