"""Every term gives what it gave when these numbers were recorded, before its formula was stated once."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    Dahl,
    DwellStiction,
    EndStop,
    FrictionLaw,
    KinematicError,
    LaggedLuGre,
    LaggedStribeck,
    LoadCoulomb,
    LoadQuadratic,
    LoadScaling,
    LoadStribeck,
    LuGre,
    OperatingPoint,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SmoothedCoulomb,
    SpringTorque,
    Stribeck,
    StribeckCurve,
    Term,
    ThermalFriction,
    ThermalViscous,
    Viscous,
)

FORWARD, REVERSE = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.06, 0.03)
FORWARD_2, REVERSE_2 = StribeckCurve(0.15, 0.60, 0.05, 0.02, 1.3), StribeckCurve(0.2, 0.7, 0.05, 0.03, 0.8)
LOAD = LoadScaling(0.6, 1.3)
RECORDED: list[tuple[Term, list[float]]] = [
    (
        Coulomb(coulomb_torque=0.3, load=LOAD),
        [
            0.2170701986590265,
            0.2170701986590265,
            0.27295423564671145,
            0.27295423564671145,
            0.23148685767889263,
            0.23148685767889263,
            -0.24371123224561486,
            -0.24371123224561486,
        ],
    ),
    (
        Viscous(viscous_coefficient=0.7),
        [
            0.07257268033360506,
            0.07257268033360506,
            0.17253981013524325,
            0.17253981013524325,
            0.0693917859985113,
            0.0693917859985113,
            -0.2736630186369158,
            -0.2736630186369158,
        ],
    ),
    (
        Coulomb(coulomb_torque=0.3, load=LOAD),
        [
            0.2170701986590265,
            0.2170701986590265,
            0.27295423564671145,
            0.27295423564671145,
            0.23148685767889263,
            0.23148685767889263,
            -0.24371123224561486,
            -0.24371123224561486,
        ],
    ),
    (
        SmoothedCoulomb(coulomb_torque=0.3, smoothing_velocity=0.02, shape="tanh", load=LOAD),
        [
            0.2170565510265933,
            0.2170565510265933,
            0.27295423563593707,
            0.27295423563593707,
            0.23146393185959163,
            0.23146393185959163,
            -0.24371123224561486,
            -0.24371123224561486,
        ],
    ),
    (
        SmoothedCoulomb(coulomb_torque=0.3, smoothing_velocity=0.02, shape="arctan", load=LOAD),
        [
            0.19073522885095254,
            0.19073522885095254,
            0.25888539583879205,
            0.25888539583879205,
            0.2021485335958567,
            0.2021485335958567,
            -0.23578094071586242,
            -0.23578094071586242,
        ],
    ),
    (
        BidirectionalStribeck(forward=FORWARD, reverse=REVERSE, load=LOAD),
        [
            0.11502914637346957,
            0.11502914637346957,
            0.14140682669578997,
            0.14140682669578997,
            0.12454153066135747,
            0.12454153066135747,
            -0.1742025699148492,
            -0.1742025699148492,
        ],
    ),
    (
        BidirectionalStribeck(forward=FORWARD_2, reverse=REVERSE_2, load=LOAD),
        [
            0.13526681433099352,
            0.13526681433099352,
            0.1415504252068792,
            0.1415504252068792,
            0.14815747062034307,
            0.14815747062034307,
            -0.1764834435490026,
            -0.1764834435490026,
        ],
    ),
    (
        Stribeck(curve=FORWARD, load=LOAD),
        [
            0.11502914637346957,
            0.11502914637346957,
            0.14140682669578997,
            0.14140682669578997,
            0.12454153066135747,
            0.12454153066135747,
            -0.1296745595124336,
            -0.1296745595124336,
        ],
    ),
    (
        Dahl(coulomb_torque=0.4, sigma_0=5000.0, load=LOAD),
        [
            0.2894269315453687,
            0.28808411177362575,
            0.36393898086228194,
            0.36393604351466796,
            0.30864914357185685,
            0.30909617575449205,
            -0.3249483096608199,
            -0.32494830044387246,
        ],
    ),
    (
        LuGre(forward=FORWARD, reverse=REVERSE, sigma_0=6000.0, sigma_1=5.0, load=LOAD),
        [
            0.11502914637346957,
            0.11503068267128487,
            0.14140682669578997,
            0.14140682670337465,
            0.12454153066135747,
            0.12454083634208707,
            -0.1742025699148492,
            -0.1742025699149177,
        ],
    ),
    (
        LuGre(forward=FORWARD_2, reverse=REVERSE_2, sigma_0=6000.0, sigma_1=5.0, load=LOAD),
        [
            0.13526681433099352,
            0.13527635748802527,
            0.1415504252068792,
            0.1415504252080099,
            0.14815747062034307,
            0.148159709682278,
            -0.1764834435490026,
            -0.17648344354911405,
        ],
    ),
    (
        LaggedStribeck(forward=FORWARD, reverse=REVERSE, load=LOAD, lag=0.004),
        [
            0.11502914637346957,
            0.20799946028049546,
            0.14140682669578997,
            0.1396195568819466,
            0.12454153066135747,
            0.11887202833428538,
            -0.1742025699148492,
            -0.16789979241720165,
        ],
    ),
    (
        LaggedLuGre(forward=FORWARD, reverse=REVERSE, sigma_0=6000.0, sigma_1=5.0, load=LOAD, lag=0.004),
        [
            0.11502914637346957,
            0.15471708424159364,
            0.14140682669578997,
            0.13925103420199794,
            0.12454153066135747,
            0.11914626525943943,
            -0.1742025699148492,
            -0.10474292184803159,
        ],
    ),
    (
        Cogging(sine=0.05, cosine=-0.03, order=9.0),
        [
            0.05797274311971502,
            0.05797274311971502,
            -0.0472605214174482,
            -0.0472605214174482,
            0.014695399318784236,
            0.014695399318784236,
            -0.03481630896592884,
            -0.03481630896592884,
        ],
    ),
    (
        PositionCoulomb(sine=0.04, cosine=0.02, order=3.0),
        [
            -0.03478450035860594,
            -0.03478450035860594,
            -0.003948308463714523,
            -0.003948308463714523,
            0.014003572873895143,
            0.014003572873895143,
            0.00845123539303554,
            0.00845123539303554,
        ],
    ),
    (
        SpringTorque(stiffness=0.3, centre=0.1, hardening=0.2),
        [
            -0.1755514755239924,
            -0.1755514755239924,
            -0.08657957486818167,
            -0.08657957486818167,
            0.22535681492166743,
            0.22535681492166743,
            -0.09730464962437838,
            -0.09730464962437838,
        ],
    ),
    (EndStop(stiffness=2.0, edge=-0.5, side=-1.0), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    (
        EndStop(stiffness=2.0, edge=0.5, side=1.0),
        [0.0, 0.0, 0.0, 0.0, 0.5729724503381202, 0.5729724503381202, 0.0, 0.0],
    ),
    (
        LoadCoulomb(coefficient=0.1),
        [
            0.1472908174003334,
            0.1472908174003334,
            0.032581989598610556,
            0.032581989598610556,
            0.09642386253599566,
            0.09642386253599566,
            -0.11976924252692552,
            -0.11976924252692552,
        ],
    ),
    (
        LoadQuadratic(coefficient=0.02),
        [
            0.043389169780916705,
            0.043389169780916705,
            0.002123172092407933,
            0.002123172092407933,
            0.01859512253272117,
            0.01859512253272117,
            -0.02868934291094701,
            -0.02868934291094701,
        ],
    ),
    (
        LoadStribeck(coefficient=0.1, stribeck_velocity=0.07),
        [
            0.016425343937538705,
            0.016425343937538705,
            1.3432679610114636e-07,
            1.3432679610114636e-07,
            0.012977897049605917,
            0.012977897049605917,
            -3.403535338182412e-15,
            -3.403535338182412e-15,
        ],
    ),
    (
        QuadraticDrag(coefficient=0.05),
        [
            0.0005374279521228191,
            0.0005374279521228191,
            0.003037753681786305,
            0.003037753681786305,
            0.0004913489759248152,
            0.0004913489759248152,
            -0.007641984466272338,
            -0.007641984466272338,
        ],
    ),
    (
        PowerLawViscous(coefficient=0.1, exponent=0.6),
        [
            0.025668770906661444,
            0.025668770906661444,
            0.043159337089707935,
            0.043159337089707935,
            0.024987684583799564,
            0.024987684583799564,
            -0.0569207801532169,
            -0.0569207801532169,
        ],
    ),
    (
        ThermalViscous(slope=0.002, reference_temperature=25.0),
        [
            -0.005188299784435885,
            -0.005188299784435885,
            0.0015654164883274933,
            0.0015654164883274933,
            -0.0018064582171426434,
            -0.0018064582171426434,
            0.030372085092825896,
            0.030372085092825896,
        ],
    ),
    (
        ThermalFriction(
            forward_viscous=0.05,
            reverse_viscous=0.08,
            viscous_slope=0.002,
            coulomb_slope=0.001,
            reference_temperature=30.0,
        ),
        [
            -0.022878466103543233,
            -0.022878466103543233,
            0.012942845605159178,
            0.012942845605159178,
            -0.004863104840834231,
            -0.004863104840834231,
            0.05170011479987636,
            0.05170011479987636,
        ],
    ),
    (
        KinematicError(sine=0.002, cosine=-0.001, order=9.0, load_inertia=0.3, gravity_cosine=1.0, gravity_sine=-0.5),
        [
            -0.007146966877992401,
            -0.007146966877992401,
            -0.013440528920217102,
            -0.013440528920217102,
            0.006733102731752794,
            0.006733102731752794,
            -0.02553382659829088,
            -0.02553382659829088,
        ],
    ),
    (
        DwellStiction(rise=0.2, time_constant=0.3, travel=0.005, rest_speed=0.003),
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ),
]
"""Steady torque, and torque after three steps of 1 ms, at each of four points [N·m]."""


def draw_points() -> list[OperatingPoint]:
    rng = np.random.default_rng(1)
    columns = (
        rng.normal(size=4) * 0.3,
        rng.uniform(-1.2, 1.2, 4),
        rng.normal(size=4) * 3,
        rng.normal(size=4) * 2,
        rng.uniform(0.5, 2, 4),
        rng.uniform(5, 65, 4),
    )
    return [OperatingPoint(*row) for row in np.column_stack(columns).tolist()]


@pytest.mark.parametrize(("term", "recorded"), RECORDED, ids=lambda value: getattr(value, "name", ""))
def test_a_term_gives_what_it_gave(term: Term, recorded: list[float]) -> None:
    law, found = FrictionLaw((term,)), []
    state = law.rest_state()
    for point in draw_points():
        found.append(float(np.asarray(term.torque(point))))
        for _ in range(3):
            torque, state = law.advance(state, point, 1e-3)
        found.append(float(torque))
    assert found == pytest.approx(recorded, rel=1e-12, abs=1e-15)
