"""One formula a term: arrays, compensator, C, ONNX, simulated joint and model file all follow from it.

The tests run over all registered terms, of which two are defined here and nowhere else.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, get_args, get_origin, get_type_hints

import numpy as np
import pytest

from fricomp.control import Compensator
from fricomp.control.compensation.curve import split_law
from fricomp.errors import ParameterError
from fricomp.export import closed_form_graph, render_c_header, save_graph, state_columns
from fricomp.export.c_source import C
from fricomp.export.onnx_nodes import OPERATORS
from fricomp.laws import (
    Cogging,
    Coulomb,
    DynamicTerm,
    FrictionLaw,
    OperatingPoint,
    Parts,
    Term,
    TracedPoint,
    term_class,
    term_names,
    trace_parts,
)
from fricomp.laws.expression import FUNCTIONS, Call, Symbol, differentiate
from fricomp.laws.source import PYTHON, compile_python, print_python
from fricomp.laws.term import require_positive
from fricomp.model import FrictionModel, Validity, decode_model, encode_model
from fricomp.sim_bench.stand_in.friction import Contact, JointFriction

PERIOD, SAMPLES = 1e-3, 200
STRONG = Coulomb(9.0)  # leaves something of dry friction whatever lowers it


@dataclass(frozen=True)
class Seal(Term):
    """A seal that grips around a place, and less where it is warm: c (1 - tanh(|q - q_0|/w)) / (1 + T/T_0)."""

    name: ClassVar[str] = "test_seal"
    units: ClassVar[Mapping[str, str]] = {
        "grip": "{torque}",
        "place": "{position}",
        "width": "{position}",
        "warmth": "°C",
    }

    grip: float
    place: float
    width: float
    warmth: float

    def __post_init__(self) -> None:
        require_positive(self, "grip", "width", "warmth")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        near = 1.0 - np.tanh(np.abs(point.position - self.place) / self.width)
        warm = np.clip(point.temperature_or(0.0) / self.warmth, 0.0, 5.0)
        return Parts(dry=self.grip * near / (1.0 + warm), drag=np.where(warm > 2.0, 0.1, 0.2) * point.velocity)


@dataclass(frozen=True)
class Grease(DynamicTerm):
    """Grease that thins while it is sheared: x' = (|v|/v_0 - x)/T, tau = c v / (1 + x)."""

    name: ClassVar[str] = "test_grease"
    states: ClassVar[tuple[str, ...]] = ("shear",)
    units: ClassVar[Mapping[str, str]] = {
        "coefficient": "{torque}·s/{position}",
        "velocity": "{position}/s",
        "time": "s",
    }

    coefficient: float
    velocity: float
    time: float

    def __post_init__(self) -> None:
        require_positive(self, "coefficient", "velocity", "time")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque in steady sliding."""
        return Parts(drag=self.coefficient * point.velocity / (1.0 + np.abs(point.velocity) / self.velocity))

    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """Shear after `dt` [s]."""
        steady = np.abs(point.velocity) / self.velocity
        return (steady + (before[0] - steady) * np.exp(-dt / self.time),)

    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """Torque of the sheared grease."""
        return Parts(drag=self.coefficient * point.velocity / (1.0 + after[0]))


def draw(cls: Any, rng: np.random.Generator) -> Any:
    """An instance with numbers of its own; a field that takes no such number gets 1."""
    hints = get_type_hints(cls)
    values = {f.name: _draw_field(hints[f.name], rng) for f in fields(cls)}
    for attempt in (values, *(values | {name: 1.0} for name in values)):
        try:
            return cls(**attempt)
        except (ParameterError, AttributeError):
            continue
    raise AssertionError(f"no numbers found for {cls.__name__}")


def _draw_field(hint: Any, rng: np.random.Generator) -> Any:
    if is_dataclass(hint):
        return draw(hint, rng)
    return rng.choice(get_args(hint)).item() if get_origin(hint) is Literal else float(rng.uniform(0.2, 1.2))


def make_model(term: Term) -> FrictionModel:
    """A law of the term alone where it is a dry curve, else beside strong friction."""
    alone = FrictionLaw((term,))
    law = FrictionLaw((STRONG, term)) if split_law(alone).extra else alone
    # Terms beside a curve know no normal load.
    normal_load = (0.1, 9.0) if not split_law(law).extra else None
    return FrictionModel(law, validity=Validity(velocity=(-3.0, 3.0), normal_load=normal_load))


def draw_points(model: FrictionModel, seed: int = 5) -> list[OperatingPoint]:
    rng = np.random.default_rng(seed)
    velocity = np.repeat(rng.normal(size=SAMPLES // 4) * 10.0 ** rng.uniform(-3.0, 0.3, SAMPLES // 4), 4).clip(
        -2.9, 2.9
    )
    low, high = [-1.2, -5.0, -4.0, 1.2, 0.0], [1.2, 5.0, 4.0, 2.4, 2.0]
    columns = np.column_stack([velocity, rng.uniform(low, high, (SAMPLES, 5))]).tolist()
    has_load = model.validity.normal_load is not None
    return [OperatingPoint(v, q, a, carried, n if has_load else None, hot) for v, q, a, carried, n, hot in columns]


def follow_law(law: FrictionLaw, points: Sequence[OperatingPoint]) -> list[float]:
    state, found = law.rest_state(), []
    for point in points:
        torque, state = law.advance(state, point, PERIOD)
        found.append(float(torque))
    return found


def make_compensator(model: FrictionModel) -> Compensator:
    anything = (-np.inf, np.inf)
    given: dict[str, Any] = {} if split_law(model.law).smoothing else {"smoothing": 1e-9}
    given |= {f"{name}_range": anything for name in ("load_torque", "temperature", "acceleration")}
    return Compensator(model, period=PERIOD, source="reference", gain=1.0, authority=1e6, **given)


@pytest.fixture(params=[(name, seed) for name in term_names() for seed in (0, 1)], ids=lambda p: f"{p[0]}-{p[1]}")
def term(request: pytest.FixtureRequest) -> Term:
    name, seed = request.param
    drawn: Term = draw(term_class(name), np.random.default_rng(seed))
    return drawn


def test_the_compensator_gives_the_law(term: Term) -> None:
    model = make_model(term)
    points, compensator = draw_points(model), make_compensator(model)
    found = []
    for p in points:
        told: Any = (p.normal_load, p.position, p.load_torque, p.temperature, p.acceleration)
        found.append(compensator.torque(float(np.asarray(p.velocity)), None, None, *told))
    assert found == pytest.approx(follow_law(model.law, points), rel=1e-11, abs=1e-12)
    assert compensator.rejected == 0


MAIN = """#include "friction.h"
#include <stdio.h>
int main(void)
{
    joint_state_t state;
    double v, q, a, l, n, t;
    joint_reset(&state);
    while (scanf("%lf %lf %lf %lf %lf %lf", &v, &q, &a, &l, &n, &t) == 6) {
        joint_input_t in = {.velocity_reference = v, .normal_load = n, .has_normal_load = HAS_LOAD EXTRA};
        printf("%.17g\\n", joint_torque(&state, &in));
    }
    return 0;
}
"""
EXTRA = ", .position = q, .acceleration = a, .load_torque = l, .temperature = t, .has_temperature = true"
FLAGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wdouble-promotion"]


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_c_gives_the_law(term: Term, tmp_path: Path) -> None:
    model = make_model(term)
    points = draw_points(model)
    header = render_c_header(model, make_compensator(model).settings, period=PERIOD, prefix="joint")
    (tmp_path / "friction.h").write_text(header)
    main = MAIN.replace("HAS_LOAD", "true" if model.validity.normal_load else "false")
    (tmp_path / "main.c").write_text(main.replace("EXTRA", EXTRA if "has_temperature" in header else ""))
    subprocess.run(["gcc", *FLAGS, "main.c", "-o", "main", "-lm"], cwd=tmp_path, check=True, capture_output=True)
    rows = [
        (p.velocity, p.position, p.acceleration, p.load_torque, p.normal_load or 0.0, p.temperature) for p in points
    ]
    text = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in rows)
    done = subprocess.run(["./main"], cwd=tmp_path, input=text, check=True, capture_output=True, text=True)
    found = [float(word) for word in done.stdout.split()]
    assert found == pytest.approx(follow_law(model.law, points), rel=1e-11, abs=1e-12)


def test_onnx_gives_the_law_in_steady_sliding(term: Term, tmp_path: Path) -> None:
    pytest.importorskip("onnx")
    runtime = pytest.importorskip("onnxruntime")
    model = make_model(term)
    points = draw_points(model)
    columns = state_columns([model])
    state = np.array([[getattr(p, name) or 0.0 for name in columns] for p in points], dtype=np.float32)
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    session = runtime.InferenceSession(str(tmp_path / "a.onnx"), providers=["CPUExecutionProvider"])
    found = session.run(None, {"state": state})[0][:, 0]
    told = dict(zip(columns, state.T.astype(np.float64), strict=True))
    if model.validity.normal_load is None:
        told.pop("normal_load")
    expected = np.asarray(model.law.torque(told.pop("velocity"), **told))
    assert np.max(np.abs(found - expected)) <= 4e-6 * np.max(np.abs(expected))


def test_the_simulated_joint_gives_the_law_while_it_slides(term: Term) -> None:
    model = make_model(term)
    friction, contact, found = JointFriction(model.law), Contact(), []
    points = draw_points(model)
    for p in points:
        for name in ("position", "acceleration", "load_torque", "normal_load", "temperature"):
            setattr(contact, name, getattr(p, name))
        velocity = float(np.asarray(p.velocity))
        applied = friction.applied(velocity, contact, PERIOD)
        found.append(applied + float(np.sign(velocity)) * friction.level(velocity, velocity, 0.0, contact))
    assert found == pytest.approx(follow_law(model.law, points), rel=1e-11, abs=1e-12)


def test_a_model_file_holds_the_term(term: Term) -> None:
    model = make_model(term)
    assert decode_model(encode_model(model)).law == model.law


def test_arrays_are_their_samples(term: Term) -> None:
    model = make_model(term)
    points = draw_points(model)
    names = [f.name for f in fields(OperatingPoint) if model.validity.normal_load or f.name != "normal_load"]
    columns = {name: np.array([getattr(p, name) for p in points]) for name in names}
    found = np.asarray(model.law.torque(columns.pop("velocity"), **columns))
    expected = [sum(float(np.asarray(t.torque(p))) for t in model.law.terms) for p in points]
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-15)


def test_a_term_of_a_single_file_is_what_its_formula_says() -> None:
    seal = Seal(grip=2.0, place=0.1, width=0.5, warmth=40.0)
    law = FrictionLaw((STRONG, seal))
    expected = 9.0 + 2.0 * (1.0 - np.tanh(0.4)) / 1.5 + 0.2 * 0.7
    assert law.torque(0.7, position=0.3, temperature=20.0) == pytest.approx(expected, rel=1e-14)
    compensator = make_compensator(FrictionModel(law, validity=Validity(velocity=(-3.0, 3.0))))
    assert compensator.inputs == {"position", "temperature"}
    assert compensator.torque(0.7, position=0.3, temperature=20.0) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_every_function_of_a_formula_is_printed_everywhere(function: str) -> None:
    assert function in PYTHON.functions
    assert function in C(is_float=True)._language.functions
    assert function in OPERATORS
    x = Symbol("x")
    arguments = {"where": (x > 0.3, x * 2.0, x - 1.0)}.get(function, (x, x + 0.7) if _takes_two(function) else (x,))
    call: Any = Call(function, *arguments)
    lines, (text,) = print_python([call])
    printed = compile_python(["def f(x):", *(f"    {line}" for line in lines), f"    return {text}"], "f")
    for value in (0.2, 0.9, 0.5):
        numbers = {"where": (value > 0.3, value * 2.0, value - 1.0)}.get(function, (value, value + 0.7))
        direct = getattr(np, function)(*numbers[: len(arguments)])
        assert printed(value) == pytest.approx(float(direct), rel=1e-15)


def _takes_two(function: str) -> bool:
    return function in (*FUNCTIONS[:5], *FUNCTIONS[-4:], "maximum", "minimum")


@pytest.mark.parametrize(
    "formula",
    [
        lambda x: np.exp(-((x / 0.3) ** 2)) * np.sin(3.0 * x) - np.expm1(-x) / (1.0 + x**2),
        lambda x: np.tanh(x) * np.arctan(2.0 * x) + np.abs(x - 0.5) * np.cos(x) + x**1.7,
        lambda x: np.where(x > 0.4, x * x, np.maximum(x, 0.2) - np.minimum(3.0 * x, 0.9)),
    ],
)
def test_derivatives_are_those_of_differences(formula: Any) -> None:
    rate = differentiate(formula(Symbol("x")), "x")
    assert rate is not None
    lines, (text,) = print_python([rate])
    derivative = compile_python(["def f(x):", *(f"    {line}" for line in lines), f"    return {text}"], "f")
    for x in (0.15, 0.27, 0.45, 0.8):
        assert derivative(x) == pytest.approx((formula(x + 1e-6) - formula(x - 1e-6)) / 2e-6, rel=1e-7)


def test_a_formula_that_cannot_be_printed_says_so() -> None:
    velocity: Any = TracedPoint().velocity
    with pytest.raises(ParameterError, match=r"cannot use np\.sinh: it may use np\.add"):
        np.sinh(velocity)
    with pytest.raises(ParameterError, match=r"use np\.where"):
        bool(velocity > 0.0)
    with pytest.raises(ParameterError, match="numbers and inputs only, got '__import__'"):
        velocity * "__import__"


def test_no_text_of_a_model_becomes_code() -> None:
    """A model file may hold any text as its joint or unit; the generated text has none of it, and numbers only."""
    law = FrictionLaw((STRONG, Seal(2.0, 0.1, 0.5, 40.0)))
    model = FrictionModel(law, joint="__import__('os')", torque_unit="exit()")
    source = make_compensator(model)._hot.source
    assert "import" not in source
    assert "exit" not in source
    assert source == make_compensator(FrictionModel(law))._hot.source


def test_a_text_in_the_place_of_a_parameter_is_refused() -> None:
    term = Cogging(0.1, 0.2, 9.0)
    object.__setattr__(term, "sine", "__import__('os')")
    with pytest.raises(ParameterError, match="numbers and inputs only"):
        trace_parts(term)
