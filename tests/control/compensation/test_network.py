"""Compensation by a network: the same friction, the same bounds."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from fricomp.control import NetworkCompensator
from fricomp.control.compensation.network_file import Loads, read_loads
from fricomp.control.compensation.trust import LARGEST_EXTRAPOLATION
from fricomp.errors import ModelFileError, ParameterError
from fricomp.export import closed_form_graph, save_graph
from fricomp.laws import BidirectionalStribeck, FrictionLaw, LoadScaling, StribeckCurve
from fricomp.model import FrictionModel, Validity

pytest.importorskip("onnx")
pytest.importorskip("onnxruntime")

CURVES = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
LOADS = Validity(normal_load=(0.5, 5.0))
MODELS = [
    FrictionModel(FrictionLaw((BidirectionalStribeck(*pair),)), validity=LOADS) for pair in (CURVES, CURVES[::-1])
]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    save_graph(closed_form_graph(MODELS), tmp_path / "arm.onnx", {"velocity_range": "-1 1"})
    return tmp_path / "arm.onnx"


def make(path: Path) -> NetworkCompensator:
    return NetworkCompensator(path, gain=1.0, largest_share=math.inf)


def test_torque_is_the_models(path: Path) -> None:
    network, out = make(path), [0.0, 0.0]
    assert network.n_joints == 2
    for velocity in ([0.03, -0.2], [-0.5, 0.9]):
        network.torque_into(out, velocity)
        expected = [float(model.torque(v)) for model, v in zip(MODELS, velocity, strict=True)]
        assert out == pytest.approx(expected, rel=1e-4)
    network.torque_into(out, [0.4, 0.4], [1.5, 0.5])
    assert out[0] == pytest.approx(float(MODELS[0].torque(0.4, normal_load=1.5)), rel=1e-5)


def test_rest_is_zero_and_the_range_is_kept(path: Path) -> None:
    network, out = make(path), [9.0, 9.0]
    network.torque_into(out, [0.0, 0.0])
    assert out == [0.0, 0.0]
    network.torque_into(out, [5.0, -5.0])
    assert out == [0.0, 0.0]


def torque(network: NetworkCompensator, velocity: float, load: float | None = None) -> float:
    out = [9.0]
    network.torque_into(out, [velocity], None if load is None else [load])
    return out[0]


def make_loaded(folder: Path, scaling: LoadScaling, loads: tuple[float, float] | None) -> NetworkCompensator:
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(*CURVES, scaling),)), validity=Validity(normal_load=loads))
    save_graph(closed_form_graph([model]), folder / "a.onnx", {"velocity_range": "-1 1"})
    return make(folder / "a.onnx")


@pytest.mark.parametrize("load", [20.0, 50.0, 80.0])
def test_friction_at_every_load_of_the_range_is_within_the_authority(load: float, tmp_path: Path) -> None:
    scaling = LoadScaling(1.0, 50.0)
    network = make_loaded(tmp_path, scaling, (20.0, 80.0))
    law = BidirectionalStribeck(*CURVES, scaling)
    for velocity in (0.006, 0.03, -0.2):
        expected = float(FrictionLaw((law,)).torque(velocity, normal_load=load)) * math.tanh(abs(velocity) / 0.005)
        assert torque(network, velocity, load) == pytest.approx(expected, rel=1e-5)


def test_loads_start_at_the_reference_and_stay_in_the_range(tmp_path: Path) -> None:
    network = make_loaded(tmp_path, LoadScaling(1.0, 50.0), (20.0, 80.0))
    assert torque(network, 0.1) == torque(network, 0.1, 50.0)
    assert torque(network, 0.1, 1.0) == torque(network, 0.1, 20.0)
    assert torque(network, 0.1, 1e30) == torque(network, 0.1, 80.0) == torque(network, 0.1)


def test_a_load_beyond_single_precision_is_rejected_and_forgotten(tmp_path: Path) -> None:
    network = make_loaded(tmp_path, LoadScaling(1.0, 50.0), None)
    before = torque(network, 0.1)
    assert before == pytest.approx(float(MODELS[0].torque(0.1)), rel=1e-5)
    assert (torque(network, 0.1, 1e39), torque(network, -1e39), network.rejected) == (0.0, 0.0, 2)
    assert torque(network, 0.1) == before


def test_each_joint_of_a_file_has_its_loads() -> None:
    about = {"normal_load_range": "20 80; ; 1 5", "reference_load": "30; 7; 9"}
    assert read_loads(about, 3) == [Loads(20.0, 80.0, 30.0), Loads(usual=7.0), Loads(1.0, 5.0, 5.0)]
    assert read_loads({"normal_load_range": "20 80"}, 2) == [Loads(20.0, 80.0, 50.0)] * 2
    assert read_loads({"normal_load_range": ""}, 1) == [Loads()]


@pytest.mark.parametrize("bad", [[math.nan, 0.1], [0.1, math.inf], [None, 0.1]])
def test_what_is_not_finite_gives_zeros_and_is_counted(path: Path, bad: list[float]) -> None:
    network, out = make(path), [9.0, 9.0]
    network.torque_into(out, bad)
    assert (out, network.rejected) == ([0.0, 0.0], 1)


def test_network_too_slow_for_the_period_is_refused(path: Path) -> None:
    with pytest.raises(ParameterError, match="closed form"):
        NetworkCompensator(path, period=1e-9)


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.onnx").write_bytes(b"nothing")
    with pytest.raises(ModelFileError):
        NetworkCompensator(tmp_path / "x.onnx")


@pytest.mark.parametrize(
    "stated",
    [
        *({"largest_torque": word} for word in ("nan", "abc", "inf", "0", "-1")),
        *({"velocity_range": words} for words in ("1 -1", "nan 1", "a b", "0 0", "-inf inf")),
        *({"normal_load_range": words} for words in ("1", "5 1", "nan 1", "-inf inf", "1 5; 1 5; 1 5")),
        *({"reference_load": words} for words in ("nan", "1 2", "a")),
    ],
)
def test_a_file_that_states_what_cannot_be_is_refused(tmp_path: Path, stated: dict[str, str]) -> None:
    save_graph(closed_form_graph(MODELS), tmp_path / "a.onnx", {"velocity_range": "-1 1"} | stated)
    with pytest.raises(ModelFileError, match="states"):
        make(tmp_path / "a.onnx")


@pytest.mark.parametrize("given", [(1.0, -1.0), (math.nan, 1.0), (0.0, 0.0), (-math.inf, 1.0)])
def test_a_range_that_is_none_is_refused(path: Path, given: tuple[float, float]) -> None:
    with pytest.raises(ParameterError, match="ascending"):
        NetworkCompensator(path, velocity_range=given)


def test_range_must_be_known(tmp_path: Path) -> None:
    save_graph(closed_form_graph(MODELS[:1]), tmp_path / "a.onnx")
    with pytest.raises(ParameterError, match="velocity_range"):
        NetworkCompensator(tmp_path / "a.onnx")
    assert NetworkCompensator(tmp_path / "a.onnx", velocity_range=(-1.0, 1.0), largest_share=math.inf).n_joints == 1


def test_each_joint_has_its_own_bound_and_a_file_of_another_number_is_refused(path: Path) -> None:
    save_graph(closed_form_graph(MODELS), path, {"velocity_range": "-1 1", "largest_torque": "0.1 inf"})
    low, high = make(path).authority
    out = [9.0, 9.0]
    make(path).torque_into(out, [0.02, 0.02])
    assert out[0] == low == pytest.approx(LARGEST_EXTRAPOLATION * 0.1)
    assert high > 0.6
    save_graph(closed_form_graph(MODELS), path, {"velocity_range": "-1 1", "largest_torque": "0.1 0.1 0.1"})
    with pytest.raises(ModelFileError, match="2 joints states 3 largest torques"):
        make(path)
