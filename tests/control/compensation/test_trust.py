"""A model is refused where it says itself that it is not usable, and bounded by the friction of its data."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.control import Compensator, NetworkCompensator
from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.trust import LARGEST_EXTRAPOLATION, bound_friction, require_usable
from fricomp.errors import ExportError, ParameterError
from fricomp.export import closed_form_graph, export_mjcf, export_urdf, render_c_header, save_graph, stack_networks
from fricomp.laws import BidirectionalStribeck, FrictionLaw, LoadScaling, SmoothedCoulomb, StribeckCurve, Term
from fricomp.model import Covariance, FrictionModel, Provenance, Validity, decode_model, encode_model

LARGEST = 0.25
SPEEDS = np.linspace(-1.5, 1.5, 3001)
HUGE = BidirectionalStribeck(StribeckCurve(0.195, 0.21, 0.3, 0.056), StribeckCurve(0.197, 1.16e26, 0.0372, 0.053))


def make_model(term: Term = HUGE, status: str = "converged") -> FrictionModel:
    data = Provenance(status=status, message="a reason", largest_torque=LARGEST, slowest_speeds=(0.3, 0.3))
    return FrictionModel(FrictionLaw((term,)), validity=Validity(velocity=(-1.0, 1.0)), provenance=data)


def test_huge_static_torque_is_bounded_and_the_measured_speeds_keep_their_friction() -> None:
    model = make_model()
    bounded = bound_friction(model)
    assert bounded.reverse.static_torque == LARGEST_EXTRAPOLATION * LARGEST
    measured = np.linspace(-1.0, -0.3, 100)
    change = np.abs(np.asarray(bounded.torque(measured)) - np.asarray(model.torque(measured)))
    assert change[-1] < 1e-9
    assert np.max(change) < 0.03 * LARGEST
    assert bounded.forward == model.forward
    assert bound_friction(bounded) is bounded


@pytest.mark.parametrize("gain", [1.0, 2.0])
@pytest.mark.parametrize("velocity", [None, 0.0])
def test_no_compensation_beyond_a_small_multiple_of_what_was_measured(gain: float, velocity: float | None) -> None:
    compensator = Compensator(make_model(), gain=gain)
    assert compensator.settings.authority <= LARGEST_EXTRAPOLATION * LARGEST
    assert max(abs(compensator.torque(v, velocity)) for v in SPEEDS) <= LARGEST_EXTRAPOLATION * LARGEST
    assert "largest" in compensator.describe()


def test_smoothing_that_a_user_chooses_does_not_uncover_a_huge_level() -> None:
    model = make_model(SmoothedCoulomb(1e10, 1e10))  # 1 N·m·s/rad wherever anything was measured
    compensator = Compensator(model, smoothing=0.01, gain=1.0)
    assert max(abs(compensator.torque(v)) for v in SPEEDS) <= LARGEST_EXTRAPOLATION * LARGEST
    slow = np.array([0.05, 0.1])
    assert np.asarray(bound_friction(model).torque(slow)) == pytest.approx(slow, rel=0.02)


def test_a_law_at_its_reference_load_is_bounded_at_the_loads_of_the_data() -> None:
    curve = StribeckCurve(0.1, 5.0, 0.05, 0.01)
    model = make_model(BidirectionalStribeck(curve, curve, LoadScaling(1.0, 1.0)))
    loaded = replace(model, validity=replace(model.validity, normal_load=(2.0, 2.0)))
    assert bound_friction(loaded).forward.static_torque == pytest.approx(LARGEST_EXTRAPOLATION * LARGEST / 2.0)


@pytest.mark.parametrize("status", ["not_converged", "not_identifiable"])
def test_an_unusable_model_is_refused_unless_asked_for(status: str) -> None:
    model = make_model(status=status)
    for use in (Compensator, render_c_header, export_mjcf, export_urdf):
        with pytest.raises(ParameterError, match=rf"{status}: a reason.*any_status"):
            use(model)
        use(model, any_status=True)
    settings = choose_settings(model)
    assert settings.gain == 0.5
    assert "not usable" in settings.notes[0]


def test_exports_are_bounded_too() -> None:
    lugre = [float(word) for word in export_mjcf(make_model()).actuator["lugre"].split()]
    assert max(lugre[2:4]) <= LARGEST_EXTRAPOLATION * LARGEST
    assert float(export_urdf(make_model()).joint["friction"]) <= LARGEST_EXTRAPOLATION * LARGEST
    assert "e+25" not in render_c_header(make_model())
    assert "e+26" not in render_c_header(make_model())


def test_an_onnx_closed_form_never_leaves_the_bound(tmp_path: Path) -> None:
    runtime = pytest.importorskip("onnxruntime")
    with pytest.raises(ParameterError, match="not usable"):
        closed_form_graph([make_model(status="not_converged")])
    save_graph(closed_form_graph([make_model()]), tmp_path / "a.onnx")
    session = runtime.InferenceSession(str(tmp_path / "a.onnx"), providers=["CPUExecutionProvider"])
    state = np.column_stack([20.0 * SPEEDS, np.ones_like(SPEEDS)]).astype(np.float32)
    (torque,) = session.run(None, {"state": state})
    assert np.max(np.abs(torque)) <= LARGEST_EXTRAPOLATION * LARGEST * (1.0 + 1e-6)


def test_a_network_of_an_unusable_model_is_refused_and_any_is_bounded(tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime")
    model = FrictionModel(make_model(BidirectionalStribeck(HUGE.forward, HUGE.forward)).law)
    about = {"velocity_range": "-1 1", "status": "not_identifiable", "message": "a reason", "largest_torque": "0.05"}
    save_graph(closed_form_graph([model]), tmp_path / "a.onnx", about)
    with pytest.raises(ParameterError, match="not_identifiable: a reason"):
        NetworkCompensator(tmp_path / "a.onnx", largest_share=math.inf)
    network = NetworkCompensator(tmp_path / "a.onnx", largest_share=math.inf, any_status=True)
    assert network.authority == [LARGEST_EXTRAPOLATION * 0.05]
    with pytest.raises(ExportError, match="not_identifiable: a reason"):
        stack_networks([tmp_path / "a.onnx"])


@pytest.mark.parametrize("status", ["", "converged", "lack_of_fit", "wrong_basin_suspected"])
def test_models_and_networks_are_usable_by_one_list(status: str, tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime")
    require_usable(make_model(status=status))
    about = {"velocity_range": "-1 1", "largest_torque": "0.05"} | ({"status": status} if status else {})
    save_graph(closed_form_graph([make_model()]), tmp_path / "a.onnx", about)
    assert NetworkCompensator(tmp_path / "a.onnx", largest_share=math.inf).n_joints == 1


def test_a_model_without_a_status_is_judged_by_its_covariance() -> None:
    curve = StribeckCurve(0.15, 0.60, 0.05, 0.02)
    names = ("stribeck.forward.static_torque", "stribeck.forward.viscous_coefficient")
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),)))
    require_usable(model)  # written by hand
    require_usable(replace(model, covariance=Covariance(names, np.diag([0.1**2, 0.1**2]))))
    with pytest.raises(ParameterError, match=r"do not determine stribeck\.forward\.static_torque:"):
        require_usable(replace(model, covariance=Covariance(names, np.diag([10.0, 1e-6]))))
    assert bound_friction(model) is model


def test_a_file_without_the_new_fields_loads() -> None:
    text = encode_model(make_model()).decode()
    model = decode_model(text.encode())
    assert (model.provenance.status, model.provenance.largest_torque) == ("converged", LARGEST)
    keys = ('"status"', '"message"', '"largest_torque"', '"slowest_speeds"')
    document = json.loads(text)
    for key in keys:
        del document["provenance"][key.strip('"')]
    old = decode_model(json.dumps(document).encode())
    assert old.provenance == Provenance()
