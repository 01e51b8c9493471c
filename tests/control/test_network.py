"""Compensation by a network: the same friction, the same bounds."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from fricomp.control import LARGEST_EXTRAPOLATION, NetworkCompensator
from fricomp.errors import ModelFileError, ParameterError
from fricomp.export import closed_form_graph, save_graph
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, Validity

pytest.importorskip("onnx")
pytest.importorskip("onnxruntime")

CURVES = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
LOADS = Validity(normal_load=(0.0, 2e6))
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
    network.torque_into(out, [0.01, 0.01], [1e6, 1e6])
    assert out == pytest.approx(network.authority)


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
    assert low == pytest.approx(LARGEST_EXTRAPOLATION * 0.1)
    assert high > 0.6
    save_graph(closed_form_graph(MODELS), path, {"velocity_range": "-1 1", "largest_torque": "0.1 0.1 0.1"})
    with pytest.raises(ModelFileError, match="2 joints states 3 largest torques"):
        make(path)
