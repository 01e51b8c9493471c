"""From a mismatch between simulation and recording to named physics with evidence.

One folder is one stage; each takes values, gives a value, and imports only those before it:

    inputs → joint → effects → search → forward, evidence → samples, channels → verdict → record; `diagnose` runs them

Fifteen nouns are all that a reader needs:

- `Given`: recordings and simulation as the user gave them, checked.
- `Track`: one recording on a uniform grid, with the noise of its sensors.
- `Plant`: a rigid joint with friction, as it is simulated.
- `Problem`: recordings, their rows, and the observer that holds a simulated plant to them.
- `Nulls`: the fitted plant simulated again with noise: recordings in which nothing is missing.
- `Baseline`: the plant that fits best without any effect, and the nulls about it.
- `Effect`: one way in which joints differ from that plant, with parameters to fit.
- `Context`: the motion along which effects are computed.
- `Structure`: the plant with some effects, as one vector of parameters.
- `Explanation`: a structure that was fitted, and what speaks for and against it.
- `SearchResult`: all explanations, the best one, and the threshold of their gain.
- `Case`: what the evidence is asked about: the inputs, the baseline and what was found.
- `Findings`: the evidence: held-out errors, changed parameters, rivals, locations.
- `Verdict`: what is named, by the findings alone.
- `Diagnosis`: the record that is written once, with models and series for its report.
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
