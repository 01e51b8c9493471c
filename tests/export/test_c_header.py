"""The C header: compiled with the strictest warnings, it says what Python says."""

from __future__ import annotations

import math
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.control import Compensator
from fricomp.errors import ExportError, ParameterError
from fricomp.export import render_c_header
from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    FrictionLaw,
    KinematicError,
    LaggedLuGre,
    LaggedStribeck,
    LoadScaling,
    LuGre,
    SmoothedCoulomb,
    StribeckCurve,
    ThermalFriction,
    Viscous,
)
from fricomp.model import FrictionModel, Validity

from .models import EXTRA_TERMS, FORWARD, REVERSE, make_extended, make_lugre, make_model

FLAGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wdouble-promotion", "-O2"]
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")

MAIN = """#include "friction.h"
#include <stdio.h>
int main(void)
{
    joint_state_t state;
    joint_statef_t statef;
    joint_reset(&state);
    joint_resetf(&statef);
    double r, v, e, n;
    int hv, he, hn;
    while (scanf("%lf %lf %lf %lf %d %d %d", &r, &v, &e, &n, &hv, &he, &hn) == 7) {
        joint_input_t in = {r, v, e, n, hv != 0, he != 0, hn != 0};
        joint_inputf_t inf_ = {(float)r, (float)v, (float)e, (float)n, hv != 0, he != 0, hn != 0};
        double torque = joint_torque(&state, &in);
        float torquef = joint_torquef(&statef, &inf_);
        printf("%.17g %.9g %u\\n", torque, (double)torquef, (unsigned)state.rejected);
    }
    return 0;
}
"""


def make_heavy_lugre() -> FrictionModel:
    law = FrictionLaw((LuGre(FORWARD, REVERSE, 6000.0, 5.0, LoadScaling(1.0, 1e-3)),))
    return FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)))


CASES: dict[str, tuple[FrictionModel, dict[str, Any]]] = {
    "reference": (make_model(), {"source": "reference"}),
    "blend": (make_model(), {"source": "blend", "measured_share": 0.7}),
    "everything": (
        make_model(),
        {
            "source": "blend",
            "torque_rate": 300.0,
            "rest_velocity": 0.01,
            "error_rate": 2.0,
            "error_band": 1e-3,
            "gain": 0.9,
            "authority": 0.5,
        },
    ),
    "measured": (make_model(), {"source": "measured", "dead_band": 0.01, "smoothing": 0.03}),
    "exponents": (
        make_model(
            BidirectionalStribeck(StribeckCurve(0.15, 0.60, 0.05, 0.02, 1.3), StribeckCurve(0.2, 0.7, 0.05, 0.03, 0.8))
        ),
        {},
    ),
    "coulomb": (make_model(Coulomb(0.3), Viscous(0.1)), {}),
    "smoothed": (make_model(SmoothedCoulomb(0.3, 0.02)), {}),
    "lugre": (make_lugre(), {}),
    "lagged": (make_model(LaggedStribeck(FORWARD, REVERSE, lag=4e-3)), {"source": "blend", "measured_share": 0.7}),
    "lagged, measured": (make_model(LaggedStribeck(FORWARD, REVERSE, lag=4e-3)), {"source": "measured"}),
    "lagged lugre": (make_model(LaggedLuGre(FORWARD, REVERSE, 6000.0, 5.0, lag=4e-3)), {}),
    "lugre, position error": (
        make_model(LuGre(FORWARD, replace(REVERSE, stribeck_exponent=1.3), 6000.0, 5.0)),
        {"error_rate": 50.0},
    ),
    "lagged lugre, position error": (
        make_model(LaggedLuGre(FORWARD, REVERSE, 6000.0, 5.0, lag=4e-3)),
        {"error_rate": 50.0},
    ),
    "never fades": (make_model(), {"fade_width": math.inf}),
    "no range": (
        make_model(LaggedStribeck(FORWARD, REVERSE, lag=4e-3)),
        {"velocity_range": (-math.inf, 1e300), "normal_load_range": (-math.inf, math.inf)},
    ),
    "lugre under loads beyond all bending": (make_heavy_lugre(), {"authority": 5e3}),
    "no normal load known": (replace(make_model(), validity=Validity(velocity=(-1.0, 1.0))), {}),
}


def draw_inputs(rows: int) -> list[list[float]]:
    rng = np.random.default_rng(7)
    scale = np.array([0.3, 0.3, 5e-3, 1.0])
    values = rng.normal(size=(rows, 4)) * scale * 10.0 ** rng.uniform(-3, 0.6, size=(rows, 1))
    values[:, 3] = rng.uniform(-1.0, 3.0, rows)
    flags = rng.integers(0, 2, size=(rows, 3))
    table = np.column_stack([values, flags])
    table[::97, 0] = math.nan
    table[1::97, 1] = math.inf
    return [[float(value) for value in row] for row in table]


def run_c(
    folder: Path, header: str, inputs: list[list[float]], main: str = MAIN, numbers: int = 4
) -> np.ndarray[Any, Any]:
    """Torque in double, in float and the count of rejected inputs, for rows of `numbers` and then flags."""
    (folder / "friction.h").write_text(header)
    (folder / "main.c").write_text(main)
    subprocess.run(["gcc", *FLAGS, "main.c", "-o", "main", "-lm"], cwd=folder, check=True, capture_output=True)
    lines = "\n".join(
        " ".join([*(f"{v:.17g}" for v in row[:numbers]), *(str(int(f)) for f in row[numbers:])]) for row in inputs
    )
    done = subprocess.run(["./main"], cwd=folder, input=lines, check=True, capture_output=True, text=True)
    return np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])


@needs_gcc
@pytest.mark.parametrize("name", CASES)
def test_c_agrees_with_python(name: str, tmp_path: Path) -> None:
    model, given = CASES[name]
    compensator, inputs = Compensator(model, **given), draw_inputs(2000)
    header = render_c_header(model, compensator.settings, prefix="joint")
    found = run_c(tmp_path, header, inputs)
    expected = np.array(
        [
            compensator.torque(r, v if hv else None, e if he else None, n if hn else None)
            for r, v, e, n, hv, he, hn in inputs
        ]
    )
    largest = float(np.max(np.abs(expected)))
    assert largest > 0.1
    assert np.max(np.abs(found[:, 0] - expected)) <= 1e-12 * largest
    assert np.max(np.abs(found[:, 1] - expected)) <= 1e-6 * largest
    assert found[-1, 2] == compensator.rejected > 0


@needs_gcc
def test_a_second_header_of_the_same_prefix_is_refused_unless_it_is_the_same(tmp_path: Path) -> None:
    (tmp_path / "main.c").write_text('#include "a.h"\n#include "b.h"\nint main(void) { return 0; }\n')
    command = ["gcc", *FLAGS, "main.c", "-o", "main", "-lm"]
    (tmp_path / "a.h").write_text(render_c_header(make_model()))
    for other, refused in ((make_model(), False), (make_model(Coulomb(0.3)), True)):
        (tmp_path / "b.h").write_text(render_c_header(other))
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert ("two different headers of the prefix friction_joint" in done.stderr) == refused
        assert (done.returncode != 0) == refused


def test_header_is_ascii_and_names_its_model() -> None:
    text = render_c_header(make_model(), version="1.2")
    assert text.isascii()
    assert "fricomp 1.2" in text
    assert "friction_joint_torquef" in text


@pytest.mark.parametrize("name", ["*/ int x; /*", "**// int x; /*", "·/ int x; /*"])
def test_comment_cannot_be_ended_by_a_joint_name(name: str) -> None:
    model = make_model()
    evil = FrictionModel(model.law, joint=name, validity=model.validity)
    plain = render_c_header(FrictionModel(model.law, joint="j", validity=model.validity), prefix="joint")
    header = render_c_header(evil, prefix="joint")
    assert (header.count("*/"), header.count("/*")) == (plain.count("*/"), plain.count("/*"))


@pytest.mark.parametrize("prefix", ["", "1a", "a-b", "a b", "é"])
def test_prefix_must_be_a_c_name(prefix: str) -> None:
    with pytest.raises(ExportError, match="not a C name"):
        render_c_header(make_model(), prefix=prefix)


EXTENDED_MAIN = """#include "friction.h"
#include <stdio.h>
int main(void)
{
    joint_state_t state;
    joint_statef_t statef;
    joint_reset(&state);
    joint_resetf(&statef);
    double r, v, q, l, t, a;
    int hv, ht;
    while (scanf("%lf %lf %lf %lf %lf %lf %d %d", &r, &v, &q, &l, &t, &a, &hv, &ht) == 8) {
        joint_input_t in = {.velocity_reference = r, .velocity = v, .has_velocity = hv != 0,
                            .position = q, .load_torque = l, .temperature = t, .has_temperature = ht != 0,
                            .acceleration = a};
        joint_inputf_t inf_ = {.velocity_reference = (float)r, .velocity = (float)v, .has_velocity = hv != 0,
                               .position = (float)q, .load_torque = (float)l, .temperature = (float)t,
                               .has_temperature = ht != 0, .acceleration = (float)a};
        double torque = joint_torque(&state, &in);
        float torquef = joint_torquef(&statef, &inf_);
        printf("%.17g %.9g %u\\n", torque, (double)torquef, (unsigned)state.rejected);
    }
    return 0;
}
"""

EXTENDED: dict[str, FrictionModel] = {term.name: make_extended(term) for term in EXTRA_TERMS}
EXTENDED["dry friction gone"] = make_extended(ThermalFriction(0.05, 0.08, 0.002, 0.02, 30.0))
EXTENDED |= {"everything": make_extended(), "lugre": make_extended(*EXTRA_TERMS[:5])}
EXTENDED["lugre"] = replace(
    EXTENDED["lugre"], law=FrictionLaw((*make_lugre().law.terms, *EXTENDED["lugre"].law.terms[1:]))
)


def draw_extended(rows: int) -> list[list[float]]:
    rng = np.random.default_rng(8)
    table = np.column_stack(
        [
            rng.normal(size=(rows, 2)) * 10.0 ** rng.uniform(-3, 0.3, size=(rows, 1)),
            rng.uniform(-1.2, 1.2, rows),
            rng.uniform(-4.0, 4.0, rows),
            rng.uniform(0.0, 70.0, rows),
            rng.normal(size=rows) * 5.0,
            rng.integers(0, 2, size=(rows, 2)),
        ]
    )
    table[::97, 2] = math.nan
    table[1::97, 3] = -math.inf
    table[2::97, 4:] = [math.nan, 0.0, 1.0, 1.0]
    table[3::97, 5] = math.inf
    table[4::97, 4], table[5::97, 4] = 1e30, -1e30
    table[6::97, 5], table[7::97, 5] = 1e30, -1e30
    return [[float(value) for value in row] for row in table]


@needs_gcc
@pytest.mark.parametrize("name", EXTENDED)
def test_extended_law_in_c_agrees_with_python(name: str, tmp_path: Path) -> None:
    compensator, inputs = Compensator(EXTENDED[name], torque_rate=2000.0), draw_extended(2000)
    header = render_c_header(EXTENDED[name], compensator.settings, prefix="joint")
    found = run_c(tmp_path, header, inputs, main=EXTENDED_MAIN, numbers=6)
    expected = np.array(
        [
            compensator.torque(
                r, v if hv else None, position=q, load_torque=load, temperature=t if ht else None, acceleration=a
            )
            for r, v, q, load, t, a, hv, ht in inputs
        ]
    )
    largest = float(np.max(np.abs(expected)))
    assert largest > 0.3
    assert np.max(np.abs(found[:, 0] - expected)) <= 1e-12 * largest
    assert np.max(np.abs(found[:, 1] - expected)) <= 1e-6 * largest
    assert found[-1, 2] == compensator.rejected > 0


@needs_gcc
@pytest.mark.parametrize(
    "law", [Cogging(0.1, 0.2, 9.0), KinematicError(1e-3, 0.0, 9.0, 0.3)], ids=lambda term: term.name
)
def test_finite_input_beyond_what_a_float_can_square_gives_zero(law: Cogging | KinematicError, tmp_path: Path) -> None:
    model, far = make_extended(law), [0.5, 0.0, 1e308, 0.0, 0.0, 0.0, 0.0, 0.0]
    near = [*far[:2], 0.1, *far[3:]]
    compensator = Compensator(model)
    found = run_c(tmp_path, render_c_header(model, prefix="joint"), [near, far, near], EXTENDED_MAIN, 6)
    expected = [compensator.torque(0.5, position=row[2], acceleration=0.0) for row in (near, far, near)]
    np.testing.assert_allclose(found[:, 0], expected, rtol=1e-12)
    assert expected[1] == 0.0
    assert found[-1, 2] == compensator.rejected == 1


@needs_gcc
def test_a_wrong_load_bends_no_bristle_for_longer_than_it_lasts(tmp_path: Path) -> None:
    law = LuGre(FORWARD, REVERSE, sigma_0=6000.0, sigma_1=5.0, load=LoadScaling(1.0, 0.5))
    model = FrictionModel(FrictionLaw((law,)), validity=Validity(velocity=(-1.0, 1.0)))
    loads = [0.5] * 5 + [1e30] * 2 + [0.5] * 50 + [1e308] * 2 + [0.5] * 50
    compensator = Compensator(model)
    found = run_c(
        tmp_path,
        render_c_header(model, compensator.settings, prefix="joint"),
        [[0.3, 0.0, 0.0, n, 0.0, 0.0, 1.0] for n in loads],
    )
    np.testing.assert_allclose(found[:, 0], [compensator.torque(0.3, normal_load=n) for n in loads], rtol=1e-12)
    assert found[56, 0] == found[-1, 0] > 0.1
    assert found[-1, 1] == pytest.approx(found[-1, 0], rel=1e-6)
    assert found[-1, 2] == compensator.rejected == 2


@pytest.mark.parametrize("period", [0.0, -1.0, 10.0, math.nan])
def test_a_period_that_the_compensator_refuses_is_refused(period: float) -> None:
    with pytest.raises(ParameterError, match="the period must be positive and below 10 s"):
        Compensator(make_lugre(), period=period)
    with pytest.raises(ParameterError, match="the period must be positive and below 10 s"):
        render_c_header(make_lugre(), period=period)
