"""The model file: a friction law with its units, covariance, range of validity and provenance."""

from fricomp.model.dynamics import JointDynamics
from fricomp.model.file import (
    MODEL_SCHEMA,
    decode_model,
    encode_model,
    load_model,
    model_json_schema,
    save_model,
)
from fricomp.model.model import Covariance, FrictionModel, Motion, Provenance, Validity

__all__ = [
    "MODEL_SCHEMA",
    "Covariance",
    "FrictionModel",
    "JointDynamics",
    "Motion",
    "Provenance",
    "Validity",
    "decode_model",
    "encode_model",
    "load_model",
    "model_json_schema",
    "save_model",
]
