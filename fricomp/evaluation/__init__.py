"""One evaluator for every model that this library writes or reads: torque error in a band, and open-loop motion.

- `evaluate` takes a model or its file and a recording, and gives an `Evaluation`.
- `read_model` and `evaluate_joint` are its two steps, for many recordings of one model.
- `evaluate_arm` does the same for the files of a whole arm and recordings of all its joints.
- `refit_model` fits all numbers of a model together; `evaluate_folds` gives its errors on held-out data.
- `fit_mjcf` writes a model in the way of MuJoCo that moves most like the recording.
- `read_motion` brings a recording onto the grid on which errors are measured.
"""

from .arm import ArmEvaluation, JointErrors, evaluate_arm
from .evaluated import EquationJoint, EvaluatedJoint
from .evaluator import evaluate, evaluate_joint
from .friction_change import FrictionChange, find_friction_change
from .held_out import compute_missing_torque, evaluate_folds, measure_torque_error
from .mjcf_fit import MjcfFit, fit_mjcf
from .motion import RecordedMotion, join_motions, read_motion
from .reading import build_evaluated, read_model
from .refit import Refit, refit_model, split_folds
from .result import EVALUATION_SCHEMA, Evaluation, PositionError, TorqueError

__all__ = [
    "EVALUATION_SCHEMA",
    "ArmEvaluation",
    "EquationJoint",
    "EvaluatedJoint",
    "Evaluation",
    "FrictionChange",
    "JointErrors",
    "MjcfFit",
    "PositionError",
    "RecordedMotion",
    "Refit",
    "TorqueError",
    "build_evaluated",
    "compute_missing_torque",
    "evaluate",
    "evaluate_arm",
    "evaluate_folds",
    "evaluate_joint",
    "find_friction_change",
    "fit_mjcf",
    "join_motions",
    "measure_torque_error",
    "read_model",
    "read_motion",
    "refit_model",
    "split_folds",
]
