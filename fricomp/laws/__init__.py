"""Friction laws, composed of terms that add up."""

from fricomp.laws.bristle import Dahl, LuGre
from fricomp.laws.coulomb import Coulomb, SmoothedCoulomb, Viscous
from fricomp.laws.dwell_stiction import DwellStiction
from fricomp.laws.end_stop import EndStop
from fricomp.laws.kinematic_error import KINEMATIC_ERROR_TERMS, KinematicError
from fricomp.laws.lagged import LaggedLuGre, LaggedStribeck
from fricomp.laws.law import FrictionLaw, LawState
from fricomp.laws.load import LoadScaling
from fricomp.laws.load_coulomb import LoadCoulomb
from fricomp.laws.load_driving import LoadDriving
from fricomp.laws.load_quadratic import LoadQuadratic
from fricomp.laws.load_stribeck import LoadStribeck
from fricomp.laws.power_law_viscous import PowerLawViscous
from fricomp.laws.quadratic_drag import QuadraticDrag
from fricomp.laws.ripple import COGGING_TERMS, POSITION_COULOMB_TERMS, Cogging, PositionCoulomb
from fricomp.laws.spring_torque import SpringTorque
from fricomp.laws.stribeck import BidirectionalStribeck, Stribeck, StribeckCurve
from fricomp.laws.term import (
    DynamicTerm,
    FloatArray,
    OperatingPoint,
    Parts,
    Ranges,
    Scalar,
    Term,
    term_class,
    term_names,
)
from fricomp.laws.thermal_friction import ThermalFriction
from fricomp.laws.thermal_viscous import ThermalViscous
from fricomp.laws.tracing import INPUTS, TracedPoint, TracedStep, find_inputs, trace_parts, trace_step

__all__ = [
    "COGGING_TERMS",
    "INPUTS",
    "KINEMATIC_ERROR_TERMS",
    "POSITION_COULOMB_TERMS",
    "BidirectionalStribeck",
    "Cogging",
    "Coulomb",
    "Dahl",
    "DwellStiction",
    "DynamicTerm",
    "EndStop",
    "FloatArray",
    "FrictionLaw",
    "KinematicError",
    "LaggedLuGre",
    "LaggedStribeck",
    "LawState",
    "LoadCoulomb",
    "LoadDriving",
    "LoadQuadratic",
    "LoadScaling",
    "LoadStribeck",
    "LuGre",
    "OperatingPoint",
    "Parts",
    "PositionCoulomb",
    "PowerLawViscous",
    "QuadraticDrag",
    "Ranges",
    "Scalar",
    "SmoothedCoulomb",
    "SpringTorque",
    "Stribeck",
    "StribeckCurve",
    "Term",
    "ThermalFriction",
    "ThermalViscous",
    "TracedPoint",
    "TracedStep",
    "Viscous",
    "find_inputs",
    "term_class",
    "term_names",
    "trace_parts",
    "trace_step",
]
