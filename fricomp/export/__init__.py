"""A model as C, ONNX, MJCF, URDF, each with what it loses."""

from fricomp.export.c_header import render_c_header
from fricomp.export.fidelity import Fidelity, compute_fidelity
from fricomp.export.joined_facts import join_facts
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

__all__ = [
    "MJCF_WAYS",
    "Fidelity",
    "MjcfWay",
    "SimulatorExport",
    "apply_to_mjcf",
    "apply_to_urdf",
    "closed_form_graph",
    "compute_fidelity",
    "export_mjcf",
    "export_urdf",
    "join_facts",
    "render_c_header",
    "save_graph",
    "stack_networks",
    "state_columns",
]
