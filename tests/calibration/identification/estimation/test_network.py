import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.calibration.identification import (
    IdentificationResult,
    discrepancy,
    fit_discrepancy,
    save_identification,
)
from fricomp.calibration.network import LAYER_SIZES, TanhNetwork, distil, forward_with_jacobian
from fricomp.calibration.network.training import initial_layers
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray
from fricomp.model import load_model

from ..paper import PROBLEM, noisy


def _network() -> TanhNetwork:
    layers = initial_layers(np.random.default_rng(0), 0.01, 1e-3, uses_load=True)
    return TanhNetwork(layers, 2.0, 0.7, 10.0, 5.0)


def test_derivative_agrees_with_differences() -> None:
    network = _network()
    inputs = network.inputs(np.array([-0.3, 0.7]), np.array([8.0, 12.0]))
    weights = network.parameters()
    output, jacobian = forward_with_jacobian(network.layers, inputs)
    for k in range(0, len(weights), 97):
        shifted = weights.copy()
        shifted[k] += 1e-6
        there, _ = forward_with_jacobian(network.with_parameters(shifted).layers, inputs)
        np.testing.assert_allclose((there - output) / 1e-6, jacobian[:, k], rtol=1e-4, atol=1e-6)


def test_architecture_is_the_one_of_the_paper() -> None:
    assert LAYER_SIZES == (2, 20, 20, 20, 1)
    assert len(_network().parameters()) == 921


def test_exported_network_does_not_interpolate_noise(tmp_path: object) -> None:
    draw = noisy("relative", 0)
    result = identify(draw.velocity, draw.torque, noise="relative")
    velocity = np.linspace(-1.0, 1.0, 4002)
    exact = np.asarray(PROBLEM.law.torque(velocity))

    def error(torque: object) -> float:
        return float(np.sqrt(np.mean((np.asarray(torque) - exact) ** 2)))

    closed = error(result.model.torque(velocity))
    assert error(result.network.torque(velocity)) < 1.2 * closed
    assert result.identifying_network is not None
    assert error(result.identifying_network.torque(velocity)) > 2.0 * closed


def test_onnx_agrees_with_float64_and_says_what_it_is(tmp_path) -> None:  # type: ignore[no-untyped-def]
    runtime = pytest.importorskip("onnxruntime")
    draw = noisy("relative", 0)
    result = identify(draw.velocity, draw.torque, noise="relative", method="least_squares")
    files = save_identification(result, tmp_path)
    session = runtime.InferenceSession(str(files.network))
    velocity = np.linspace(-1.0, 1.0, 2001).astype(np.float32)
    state = np.stack([velocity, np.full_like(velocity, 3.0)], axis=1)
    torque = session.run(None, {"state": state})[0][:, 0]
    exact = np.asarray(result.network.torque(velocity.astype(np.float64)))
    assert np.max(np.abs(torque - exact)) < 2e-6 * np.max(np.abs(exact))
    metadata = session.get_modelmeta().custom_metadata_map
    assert metadata["model_json_sha256"] == files.model_sha256
    assert metadata["opset"] == "17"
    assert load_model(files.model).law == result.model.law


@pytest.mark.slow
def test_distillation_over_loads_holds_between_them() -> None:
    def torque(velocity: FloatArray, load: FloatArray | None) -> FloatArray:
        assert load is not None
        return np.asarray(np.sign(velocity) * (0.1 * load + 0.05 * np.abs(velocity)))

    assert distil(torque, 2.0, (5.0, 20.0), bend=0.05).rms_error < 5e-3


def test_training_holds_linear_algebra_to_one_thread_and_gives_it_back() -> None:
    pools = pytest.importorskip("threadpoolctl")
    from fricomp.blas import one_blas_thread

    def threads() -> list[int]:
        return [pool["num_threads"] for pool in pools.threadpool_info() if pool["user_api"] == "blas"]

    with pools.threadpool_limits(2, user_api="blas"):
        before = threads()
        with one_blas_thread():
            assert set(threads()) <= {1}
        assert threads() == before
        assert set(before) == {2}


def _repeated(speeds: int, visits: int) -> IdentificationResult:
    """Each speed visited several times, not quite the same every time."""
    side = np.repeat(np.geomspace(0.01, 1.0, speeds), visits)
    rng = np.random.default_rng(0)
    velocity = np.concatenate([-side, side]) * (1.0 + 1e-6 * rng.normal(size=2 * len(side)))
    torque = np.asarray(PROBLEM.law.torque(velocity)) + 0.01 * rng.normal(size=len(velocity))
    return identify(velocity, torque, method="least_squares", noise="absolute")


@pytest.mark.slow
def test_visits_to_one_speed_are_held_out_together(monkeypatch: pytest.MonkeyPatch) -> None:
    outside: list[FloatArray] = []
    inside: list[FloatArray] = []

    def record(result: IdentificationResult, left_out: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> object:
        outside.append(result.observations.velocity[left_out])
        inside.append(result.observations.velocity[~left_out])
        return original(result, left_out)

    original = discrepancy._fit_held_out
    monkeypatch.setattr(discrepancy, "_fit_held_out", record)
    monkeypatch.setattr(discrepancy, "train_towards", lambda network, *_: network)
    fit_discrepancy(_repeated(speeds=12, visits=3))
    assert sum(len(velocity) for velocity in outside) == 72
    for out, kept in zip(outside, inside, strict=True):
        assert np.min(np.abs(out[:, None] / kept[None, :] - 1.0)) > 0.1


@pytest.mark.slow
def test_a_fold_begins_from_the_closed_form_without_its_points(monkeypatch: pytest.MonkeyPatch) -> None:
    result = _repeated(speeds=12, visits=1)
    begun: list[TanhNetwork] = []

    def record(network: TanhNetwork, *_: object) -> TanhNetwork:
        begun.append(network)
        return network

    monkeypatch.setattr(discrepancy, "train_towards", record)
    fit_discrepancy(result)
    firsts = begun[:: len(discrepancy.WEIGHTS) - 1]
    assert len({float(network.torque(0.01)) for network in [*firsts, result.network]}) == 5


def test_a_network_is_not_chosen_from_few_speeds_however_often_each_was_visited() -> None:
    with pytest.raises(IdentificationError, match="at least 20 different speeds, got 16"):
        fit_discrepancy(_repeated(speeds=8, visits=5))


@pytest.mark.slow
def test_a_network_leaves_the_law_only_where_held_out_points_ask_for_it() -> None:
    velocity = np.concatenate([-np.geomspace(0.01, 1.0, 40), np.geomspace(0.01, 1.0, 40)])
    noise = 0.01 * np.random.default_rng(0).normal(size=len(velocity))
    exact = np.asarray(PROBLEM.law.torque(velocity))
    hump = 0.15 * np.sign(velocity) * np.exp(-(((np.abs(velocity) - 0.45) / 0.12) ** 2))
    results = [
        identify(velocity, exact + size * hump + noise, method="least_squares", noise="absolute") for size in (0.0, 1.0)
    ]
    kept, left = (fit_discrepancy(result) for result in results)
    assert not kept.departs
    assert kept.network is results[0].network
    assert left.departs
    assert left.held_out[left.weight] < 0.8 * left.held_out[np.inf]
    error = np.asarray(left.network.torque(velocity)) - exact - hump
    assert np.sqrt(np.mean(error**2)) < 0.02


@pytest.mark.slow
def test_a_network_of_one_load_is_right_at_that_load_and_without_one() -> None:
    draw = PROBLEM.draw("relative", 0)
    found = identify(draw.velocity, draw.torque, 12.5, method="least_squares")
    free = fit_discrepancy(found)
    assert free.network.load_offset == 12.5
    for speed in (-0.5, 0.5):
        assert free.network.torque(speed) == free.network.torque(speed, 12.5)
        assert free.network.torque(speed) == pytest.approx(found.model.torque(speed, normal_load=12.5), rel=0.05)
