"""ONNX graphs: the closed form as it is, and networks of several joints in one."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.control import Compensator, NetworkCompensator
from fricomp.control.compensation.trust import LARGEST_EXTRAPOLATION
from fricomp.errors import ExportError, MissingExtraError, ParameterError
from fricomp.export import closed_form_graph, save_graph, stack_networks, state_columns
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    DwellStiction,
    LaggedStribeck,
    LoadScaling,
    PositionCoulomb,
    SmoothedCoulomb,
    StribeckCurve,
    Term,
    ThermalFriction,
    Viscous,
)
from fricomp.model import FrictionModel

from .models import EXTRA_TERMS, FORWARD, REVERSE, make_extended, make_model

onnx = pytest.importorskip("onnx")
runtime = pytest.importorskip("onnxruntime")


def run(path: Path, state: Any) -> np.ndarray[Any, Any]:
    session = runtime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    (torque,) = session.run(None, {"state": np.asarray(state, dtype=np.float32)})
    return np.asarray(torque)[:, 0]


def test_closed_form_agrees_with_the_model(tmp_path: Path) -> None:
    model = make_model()
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    rng = np.random.default_rng(1)
    velocity, load = rng.uniform(-1, 1, 300).astype(np.float32), rng.uniform(0.5, 2, 300).astype(np.float32)
    expected = model.torque(velocity.astype(np.float64), normal_load=load.astype(np.float64))
    found = run(tmp_path / "a.onnx", np.column_stack([velocity, load]))
    assert np.max(np.abs(found - expected)) <= 2e-6 * np.max(np.abs(expected))


def test_without_onnx_the_extra_is_named_that_brings_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "onnx", None)
    with pytest.raises(MissingExtraError, match=r"\[onnx\]"):
        closed_form_graph([make_model()])


@pytest.mark.parametrize("load", [0.0, -3.0])
def test_far_below_the_reference_load_friction_ends_and_does_not_drive(load: float, tmp_path: Path) -> None:
    scaled = BidirectionalStribeck(FORWARD, REVERSE, load=LoadScaling(load_sensitivity=1.5, reference_load=1.0))
    model = make_model(scaled)
    model = replace(model, validity=replace(model.validity, normal_load=(-5.0, 2.0)))
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    viscous = FORWARD.viscous_coefficient * 0.5
    assert run(tmp_path / "a.onnx", [[0.5, load]])[0] == pytest.approx(viscous, rel=1e-5)
    compensator = Compensator(model, gain=1.0, smoothing=1e-6, source="reference", authority=1e3)
    assert compensator.torque(0.5, normal_load=load) == pytest.approx(viscous, rel=1e-5)


def test_several_joints_share_one_graph(tmp_path: Path) -> None:
    steep = BidirectionalStribeck(REVERSE, StribeckCurve(0.1, 0.3, 0.02, 0.5, 1.5))
    models = [make_model(), make_model(steep), make_model(Coulomb(0.4), Viscous(0.2))]
    save_graph(closed_form_graph(models), tmp_path / "arm.onnx")
    state = np.array([[0.03, 1.0], [-0.2, 1.5], [0.4, 0.7]])
    expected = [float(m.torque(v, normal_load=n)) for m, (v, n) in zip(models, state.tolist(), strict=True)]
    assert run(tmp_path / "arm.onnx", state) == pytest.approx(expected, rel=2e-6)


def test_smoothed_friction_is_smooth_beside_a_joint_that_is_not(tmp_path: Path) -> None:
    models = [make_model(SmoothedCoulomb(0.5, 0.05), Viscous(0.1)), make_model()]
    for k, chosen in enumerate((models, models[:1])):
        save_graph(closed_form_graph(chosen), tmp_path / f"{k}.onnx")
        for velocity in (0.0, 1e-6, -1e-3, 0.02, -0.3):
            expected = [float(model.torque(velocity, normal_load=1.5)) for model in chosen]
            found = run(tmp_path / f"{k}.onnx", [[velocity, 1.5]] * len(chosen))
            assert found == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("velocity", [1e-3, -1e-3])
def test_terms_beside_smoothed_friction_take_no_more_than_it_has_at_that_speed(velocity: float, tmp_path: Path) -> None:
    model = make_model(SmoothedCoulomb(0.5, 0.05), PositionCoulomb(0.0, -0.4, 1.0))
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    assert run(tmp_path / "a.onnx", [[velocity, 1.0, 0.0, 0.0, 0.0]])[0] == 0.0


def draw_state(rows: int) -> np.ndarray[Any, Any]:
    """Velocity, normal load, position, load torque, temperature, acceleration."""
    low, high = np.array([-1.0, 0.5, -1.0, -3.0, 10.0, -5.0]), np.array([1.2, 2.0, 1.0, 2.0, 60.0, 5.0])
    return np.random.default_rng(4).uniform(low, high, (rows, 6)).astype(np.float32)


def evaluate(model: FrictionModel, state: Any) -> np.ndarray[Any, Any]:
    v, normal, q, load, hot, a = np.asarray(state, dtype=np.float64).T
    inputs = {"normal_load": normal, "position": q, "load_torque": load, "temperature": hot, "acceleration": a}
    return np.asarray(model.torque(v, **inputs))


@pytest.mark.parametrize("terms", [*((term,) for term in EXTRA_TERMS), ()], ids=lambda terms: terms and terms[0].name)
def test_extended_law_agrees_with_the_model(terms: tuple[Term, ...], tmp_path: Path) -> None:
    model, state = make_extended(*terms), draw_state(300)
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    expected = evaluate(model, state)
    found = run(tmp_path / "a.onnx", state[:, : len(state_columns([model]))])
    assert np.max(np.abs(found - expected)) <= 2e-6 * np.max(np.abs(expected))


def test_terms_that_lower_dry_friction_take_no_more_than_there_is(tmp_path: Path) -> None:
    """Of two joints the second has no such term; at 90 °C the first has lost all of its dry friction, not at 20 °C."""
    models = [make_extended(ThermalFriction(0.02, 0.03, 0.0, 0.02, 30.0)), make_extended(EXTRA_TERMS[0])]
    save_graph(closed_form_graph(models), tmp_path / "arm.onnx")
    for velocity, viscous in ((0.5, FORWARD.viscous_coefficient), (-0.5, REVERSE.viscous_coefficient)):
        hot, cold = (np.array([[velocity, 1.0, 0.3, 0.0, t, 0.0]] * 2) for t in (90.0, 20.0))
        beside = float(evaluate(models[1], hot[1:])[0])
        assert run(tmp_path / "arm.onnx", hot[:, :5]) == pytest.approx([viscous * velocity, beside], rel=2e-6)
        expected = [float(evaluate(model, cold[:1])[0]) for model in models]
        assert run(tmp_path / "arm.onnx", cold[:, :5]) == pytest.approx(expected, rel=2e-6)


def test_joints_with_and_without_a_term_share_one_graph(tmp_path: Path) -> None:
    models = [make_extended(EXTRA_TERMS[0]), make_model(Coulomb(0.4)), make_extended(*EXTRA_TERMS[3:7])]
    state = draw_state(3)
    save_graph(closed_form_graph(models), tmp_path / "arm.onnx")
    expected = [float(evaluate(model, row[None])[0]) for model, row in zip(models, state, strict=True)]
    assert run(tmp_path / "arm.onnx", state[:, :5]) == pytest.approx(expected, rel=2e-6)


def make_unloaded(*terms: Term) -> FrictionModel:
    """A model whose data had no normal load; its law keeps the factor that it has by default."""
    model = make_extended(*terms)
    return replace(model, validity=replace(model.validity, normal_load=None))


@pytest.mark.parametrize("load", [0.0, 1.0, 7.0])
def test_a_normal_load_that_nobody_measured_changes_nothing(load: float, tmp_path: Path) -> None:
    model, loaded = make_unloaded(EXTRA_TERMS[4]), make_extended(EXTRA_TERMS[5])
    state = np.array([[0.5, load, 0.0, 1.5, 20.0]] * 2)
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    expected = float(np.asarray(model.torque(0.5, load_torque=1.5)))
    assert run(tmp_path / "a.onnx", state[:1])[0] == pytest.approx(expected, rel=2e-6)
    compensator = Compensator(model, gain=1.0, smoothing=1e-6, source="reference", authority=1e3)
    assert compensator.torque(0.5, normal_load=load, load_torque=1.5) == pytest.approx(expected, rel=1e-6)
    save_graph(closed_form_graph([model, loaded]), tmp_path / "arm.onnx")
    beside = [expected, float(evaluate(loaded, np.append(state[1:], [[0.0]], axis=1))[0])]
    assert run(tmp_path / "arm.onnx", state) == pytest.approx(beside, rel=2e-6)


@pytest.mark.parametrize(
    ("models", "unused"),
    [
        ((make_unloaded(EXTRA_TERMS[4]),), "normal_load, position, temperature: any finite number"),
        ((make_model(), make_unloaded(EXTRA_TERMS[0])), "load_torque, temperature: any finite number"),
        ((make_extended(),), None),
        ((make_model(),), None),
    ],
)
def test_columns_that_no_joint_uses_stand_in_the_metadata(
    models: tuple[FrictionModel, ...], unused: str | None, tmp_path: Path
) -> None:
    save_graph(closed_form_graph(models), tmp_path / "a.onnx", {"joint": "elbow"})
    about = runtime.InferenceSession(str(tmp_path / "a.onnx")).get_modelmeta().custom_metadata_map
    assert about["joint"] == "elbow"
    assert about.get("unused", "").startswith(unused) if unused else "unused" not in about


def test_terms_with_a_memory_are_those_of_steady_sliding(tmp_path: Path) -> None:
    model = make_model(LaggedStribeck(FORWARD, REVERSE, lag=0.01), DwellStiction(0.3, 0.5, 5e-3, 3e-3))
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx")
    state = draw_state(50)[:, :2]
    save_graph(closed_form_graph([make_model()]), tmp_path / "plain.onnx")
    np.testing.assert_array_equal(run(tmp_path / "a.onnx", state), run(tmp_path / "plain.onnx", state))


def make_network(
    path: Path, seed: int, sizes: tuple[int, ...] = (2, 20, 20, 1), about: dict[str, str] | None = None
) -> None:
    from fricomp.calibration.network.architecture import Layer, TanhNetwork
    from fricomp.calibration.network.onnx_file import save_network

    rng = np.random.default_rng(seed)
    layers = tuple(Layer(rng.normal(size=(n, m)) / m, rng.normal(size=n)) for m, n in pairwise(sizes))
    save_network(TanhNetwork(layers, 1.3 + seed, 1.0, 0.5, 0.7), path, about or {})


def test_stacked_networks_say_what_each_one_says(tmp_path: Path) -> None:
    paths = [tmp_path / f"{k}.onnx" for k in range(7)]
    for k, path in enumerate(paths):
        make_network(path, k, (2, 8 + k, 20, 1))
    save_graph(stack_networks(paths), tmp_path / "arm.onnx")
    state = np.random.default_rng(3).uniform(-1, 1, (7, 2))
    alone = [run(path, state[k : k + 1])[0] for k, path in enumerate(paths)]
    assert len(set(alone)) == 7
    assert run(tmp_path / "arm.onnx", state) == pytest.approx(alone, rel=1e-5, abs=1e-6)


ABOUT = {"velocity_range": "-1 1", "status": "converged", "message": "fine", "largest_torque": "0.05"}
WORSE = ABOUT | {"joint": "elbow", "velocity_range": "-2 0.5", "largest_torque": "0.1"}


def stack(folder: Path, *abouts: dict[str, str]) -> Path:
    paths = [folder / f"{k}.onnx" for k in range(len(abouts))]
    for k, (path, about) in enumerate(zip(paths, abouts, strict=True)):
        make_network(path, k, about=about)
    save_graph(stack_networks(paths, any_status=True), folder / "arm.onnx")
    return folder / "arm.onnx"


def test_stacked_networks_are_trusted_no_further_than_each_alone(tmp_path: Path) -> None:
    path = stack(tmp_path, ABOUT | {"joint": "shoulder"}, WORSE | {"status": "wrong_basin_suspected", "message": "two"})
    network = NetworkCompensator(path, largest_share=math.inf)
    assert network.authority == pytest.approx([LARGEST_EXTRAPOLATION * 0.05, LARGEST_EXTRAPOLATION * 0.1])
    about = {item.key: item.value for item in onnx.load(str(path)).metadata_props}
    assert about["velocity_range"] == "-1 0.5"
    assert (about["status"], about["message"]) == ("wrong_basin_suspected", "elbow: two")
    assert about["joint"] == "shoulder elbow"


def test_one_unusable_network_makes_the_stack_unusable(tmp_path: Path) -> None:
    path = stack(tmp_path, ABOUT, WORSE | {"status": "not_identifiable", "message": "add speeds"})
    with pytest.raises(ParameterError, match="not_identifiable: elbow: add speeds"):
        NetworkCompensator(path, largest_share=math.inf)


def test_a_stack_states_no_range_that_one_network_does_not_state(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="states no range of velocity"):
        NetworkCompensator(stack(tmp_path, ABOUT, {"status": "converged"}), largest_share=math.inf)
    with pytest.raises(ExportError, match="share no range of velocity"):
        stack(tmp_path, ABOUT, WORSE | {"velocity_range": "1 2"})


def test_networks_of_different_depth_are_refused(tmp_path: Path) -> None:
    make_network(tmp_path / "a.onnx", 0)
    make_network(tmp_path / "b.onnx", 1, sizes=(2, 8, 1))
    with pytest.raises(ExportError, match="as many layers"):
        stack_networks([tmp_path / "a.onnx", tmp_path / "b.onnx"])


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.onnx").write_bytes(b"not a graph")
    save_graph(closed_form_graph([make_model()]), tmp_path / "closed.onnx")
    for name in ("x.onnx", "missing.onnx", "closed.onnx"):
        with pytest.raises(ExportError):
            stack_networks([tmp_path / name])
