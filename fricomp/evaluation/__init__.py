"""One evaluator for every model that this library writes or reads: torque error in a band, and open-loop motion.

- `evaluate` takes a model or its file and a recording, and gives an `Evaluation`.
- `read_model` and `evaluate_joint` are its two steps, for many recordings of one model.
- `evaluate_arm` does the same for the files of a whole arm and recordings of all its joints.
- `read_motion` brings a recording onto the grid on which errors are measured.
"""

from .arm import ArmEvaluation, JointErrors, evaluate_arm
from .evaluate import evaluate, evaluate_joint
from .evaluated import EquationJoint, EvaluatedJoint
from .motion import RecordedMotion, read_motion
from .reading import build_evaluated, read_model
from .result import EVALUATION_SCHEMA, Evaluation, PositionError, TorqueError

__all__ = [
    "EVALUATION_SCHEMA",
    "ArmEvaluation",
    "EquationJoint",
    "EvaluatedJoint",
    "Evaluation",
    "JointErrors",
    "PositionError",
    "RecordedMotion",
    "TorqueError",
    "build_evaluated",
    "evaluate",
    "evaluate_arm",
    "evaluate_joint",
    "read_model",
    "read_motion",
]
