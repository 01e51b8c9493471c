"""An arm in motion: what its links weigh, and the friction of all its joints, from one recording.

The stages, each a module: `arm_recording` (all joints on one clock) → `rows` (filtered equations, `regressor`) →
`equations` (their sums) → `fit` (links, rotors and friction together) → `identification` (bandwidth, delay, what is
selected) → `confirmation` and `answer` (held-out checks) → `conclusion` (`record` and sentences) → `files`, `page`.
"""

from .examination import ArmExamination, examine_arm
from .friction_model import build_friction_model
from .prior import ArmPrior
from .record import ARM_SCHEMA, ArmRecord, load_arm_record, save_arm_record

__all__ = [
    "ARM_SCHEMA",
    "ArmExamination",
    "ArmPrior",
    "ArmRecord",
    "build_friction_model",
    "examine_arm",
    "load_arm_record",
    "save_arm_record",
]
