"""From a mismatch between simulation and recording to named physics with evidence.

The data flow, one module a step: `checks` → `loading` → `weak_form` → `preparation` (base model, `nulls`) →
`screening` → `search` (joint refits) → `confirmation` → `verdict`.
"""

from .diagnose import diagnose
from .inputs.controller import Controller, estimate_controller, read_controller
from .inputs.rigid import RigidJoint, read_simulation
from .record.record_file import diagnosis_json_schema, load_diagnosis, save_diagnosis
from .record.result import (
    DIAGNOSIS_SCHEMA,
    Change,
    Diagnosis,
    DiagnosisRecord,
    Distinguishability,
    Evidence,
    Forward,
    HeldOut,
    NamedEffect,
    NextExperiment,
    Quantity,
    Rival,
    RowSeries,
)
from .simulated import diagnose_against

__all__ = [
    "DIAGNOSIS_SCHEMA",
    "Change",
    "Controller",
    "Diagnosis",
    "DiagnosisRecord",
    "Distinguishability",
    "Evidence",
    "Forward",
    "HeldOut",
    "NamedEffect",
    "NextExperiment",
    "Quantity",
    "RigidJoint",
    "Rival",
    "RowSeries",
    "diagnose",
    "diagnose_against",
    "diagnosis_json_schema",
    "estimate_controller",
    "load_diagnosis",
    "read_controller",
    "read_simulation",
    "save_diagnosis",
]
