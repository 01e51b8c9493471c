"""A model as C, ONNX, MJCF, URDF or settings of a training simulator, each with what it loses."""

from fricomp.export.c_header import render_c_header
from fricomp.export.fidelity import Fidelity, compute_fidelity
from fricomp.export.joined_facts import join_facts
from fricomp.export.levels import FrictionLevels, fit_friction_levels
from fricomp.export.onnx_graph import closed_form_graph, save_graph, stack_networks, state_columns
from fricomp.export.simulators import (
    MJCF_WAYS,
    MjcfWay,
    SimulatorExport,
    apply_to_mjcf,
    apply_to_urdf,
    export_mjcf,
    export_urdf,
)
from fricomp.export.training import TRAINING_FORMATS, render_training

__all__ = [
    "MJCF_WAYS",
    "TRAINING_FORMATS",
    "Fidelity",
    "FrictionLevels",
    "MjcfWay",
    "SimulatorExport",
    "apply_to_mjcf",
    "apply_to_urdf",
    "closed_form_graph",
    "compute_fidelity",
    "export_mjcf",
    "export_urdf",
    "fit_friction_levels",
    "join_facts",
    "render_c_header",
    "render_training",
    "save_graph",
    "stack_networks",
    "state_columns",
]
