"""Thousands of joints in one call end where each would end alone."""

import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.calibration.batch import identify_batch
from fricomp.calibration.identification import Status
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray
from fricomp.model import Covariance
from fricomp.sim_bench.studies.identification.throughput import draw_joints, draw_parameters, measure_throughput

pytest.importorskip("torch")


@pytest.mark.parametrize("noise", ["auto", "relative", "absolute"])
def test_the_optimum_is_that_of_each_joint_alone(noise: str) -> None:
    velocity, torque = draw_joints(6, seed=3)
    batch = identify_batch(velocity, torque, noise)  # type: ignore[arg-type]
    for index, (v, tau) in enumerate(zip(velocity, torque, strict=True)):
        alone = identify(v, tau, method="least_squares", noise=noise)
        assert batch.parameter_names == alone.parameter_names
        np.testing.assert_allclose(batch.values[index], list(alone.parameters.values()), rtol=1e-5)
        deviations = list(alone.standard_deviations.values())
        np.testing.assert_allclose(batch.standard_deviations[index], deviations, rtol=1e-4)
        assert batch.noise[index] == alone.noise.kind
        assert batch.noise_level[index] == pytest.approx(alone.noise.level, rel=1e-6)
        assert batch.negative_log_likelihood[index] == pytest.approx(alone.negative_log_likelihood, abs=1e-6)
        assert batch.law(index).torque(0.3) == pytest.approx(alone.model.law.torque(0.3), rel=1e-5)


def test_joints_of_different_lengths_do_not_disturb_each_other() -> None:
    velocity, torque = draw_joints(5, seed=8)
    velocity[2], torque[2] = velocity[2][::3], torque[2][::3]
    together = identify_batch(velocity, torque)
    for index in range(5):
        alone = identify_batch(velocity[index : index + 1], torque[index : index + 1])
        np.testing.assert_allclose(together.values[index], alone.values[0], rtol=1e-7)


def test_recovers_the_parameters_that_the_points_were_drawn_from() -> None:
    velocity, torque = draw_joints(200, seed=1, noise=0.01)
    found = identify_batch(velocity, torque, "relative")
    assert set(found.status) == {Status.CONVERGED}
    true = draw_parameters(200, seed=1)
    miss = np.abs(found.values - true) / found.standard_deviations
    assert np.mean(miss < 1.96) == pytest.approx(0.95, abs=0.02)


def test_a_joint_that_cannot_be_identified_is_named() -> None:
    velocity, torque = draw_joints(2, seed=1)
    with pytest.raises(IdentificationError, match="joint 1 has 0 points in reverse"):
        identify_batch([velocity[0], np.abs(velocity[1])], [torque[0], np.abs(torque[1])])
    with pytest.raises(IdentificationError, match=r"joint 1: torque\[3\] is nan"):
        identify_batch(velocity, [torque[0], np.where(np.arange(len(torque[1])) == 3, np.nan, torque[1])])
    with pytest.raises(IdentificationError, match="2 joints with velocities and 1 with torques"):
        identify_batch(velocity, torque[:1])
    with pytest.raises(IdentificationError, match="unknown noise"):
        identify_batch(velocity, torque, "white")  # type: ignore[arg-type]
    with pytest.raises(IdentificationError, match="cannot use the device"):
        identify_batch(velocity, torque, device="cuda:99")


def test_a_joint_whose_parameters_the_points_do_not_tell_is_said_to_be_vague() -> None:
    velocity = np.concatenate([-np.linspace(0.2, 1.0, 15), np.linspace(0.2, 1.0, 15)])
    noise = 1.0 + 0.01 * np.random.default_rng(0).standard_normal(30)
    torque = 0.5 * np.sign(velocity) * noise  # neither Stribeck curve nor viscous friction
    assert identify(velocity, torque, method="least_squares").status == Status.NOT_IDENTIFIABLE
    assert identify_batch([velocity], [torque]).status == [Status.NOT_IDENTIFIABLE]


def test_throughput_compares_the_same_joints() -> None:
    found = measure_throughput(12, single=4, seed=2)
    assert found.joints == 12
    assert found.largest_difference < 1e-5
    assert "joints/s" in str(found)


def _above_the_bend(count: int) -> tuple[list[FloatArray], list[FloatArray]]:
    """Sweeps whose slowest speed lies above the Stribeck velocity, so that the information is nearly singular."""
    speed, rng = np.linspace(0.05, 2.0, 20), np.random.default_rng(0)
    velocity, torques = np.concatenate([speed, -speed]), []
    for bend in 0.02 * np.exp(0.5 * rng.standard_normal(count)):
        clean = np.sign(velocity) * (1.0 + 0.5 * np.exp(-((velocity / bend) ** 2))) + 0.3 * velocity
        torques.append(clean * (1.0 + 0.02 * rng.standard_normal(velocity.size)))
    return [velocity] * count, torques


def test_covariances_are_symmetric_where_the_information_is_nearly_singular() -> None:
    found = identify_batch(*_above_the_bend(40))
    for covariance in found.covariance:
        Covariance(found.parameter_names, covariance)
        np.testing.assert_allclose(covariance, covariance.T, rtol=1e-12)


def test_a_joint_ends_as_it_would_alone_without_viscous_friction_and_without_noise() -> None:
    speed = np.linspace(0.05, 2.0, 20)
    velocity = np.concatenate([speed, -speed])
    dry = np.sign(velocity) * (1.0 + 0.5 * np.exp(-((velocity / 0.2) ** 2)))
    noisy = dry * (1.0 + 0.005 * np.random.default_rng(1).standard_normal(velocity.size))
    exact = dry + 0.3 * velocity
    found = identify_batch([velocity, velocity], [noisy, exact])
    alone = [identify(velocity, torque, method="least_squares") for torque in (noisy, exact)]
    assert found.status == [one.status for one in alone] == [Status.CONVERGED] * 2
    assert found.verdict(0).message == alone[0].message


def _sweeps(low: float, rise: float, exponent: float = 2.0) -> tuple[list[FloatArray], list[FloatArray]]:
    """Sweeps from the slowest speed `low`; friction falls by `rise` over 0.05 rad/s."""
    speed = np.geomspace(low, 1.0, 20)
    velocity, torques = np.concatenate([speed, -speed]), []
    for seed in range(10):
        clean = 0.3 + rise * np.exp(-((np.abs(velocity) / 0.05) ** exponent)) + 0.1 * np.abs(velocity)
        torques.append(np.sign(velocity) * (clean + 0.01 * np.random.default_rng(seed).standard_normal(40)))
    return [velocity] * 10, torques


@pytest.mark.slow
@pytest.mark.parametrize(
    ("low", "rise", "exponent"), [(0.01, 0.4, 2.0), (0.01, 0.4, 1.0), (0.01, 0.0, 2.0), (0.3, 0.4, 2.0)]
)
def test_a_joint_is_judged_as_it_is_alone_and_within_the_same_bounds(low: float, rise: float, exponent: float) -> None:
    velocity, torque = _sweeps(low, rise, exponent)
    found = identify_batch(velocity, torque)
    for index, (v, tau) in enumerate(zip(velocity, torque, strict=True)):
        alone, verdict = identify(v, tau, method="least_squares"), found.verdict(index)
        assert (verdict.status, verdict.message) == (alone.status, alone.message)
        assert np.max(found.values[index, [0, 1, 4, 5]]) <= 10.0 * np.max(np.abs(tau)) * (1.0 + 1e-9)


def test_a_second_basin_is_seen_as_it_is_alone() -> None:
    velocity, torque = draw_joints(40, seed=5, noise=0.3)
    found = identify_batch(velocity, torque, "relative")
    alone = [identify(v, t, method="least_squares", noise="relative") for v, t in zip(velocity, torque, strict=True)]
    assert found.status == [one.status for one in alone]
    assert np.any(np.isfinite(found.rival))
