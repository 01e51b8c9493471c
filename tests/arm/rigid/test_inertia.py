"""Inertia of links: every value of the coordinates is a body that can exist, and zero is the simulation."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.arm.rigid.inertia import N_INERTIA, LinkCoordinates, combine_inertia, to_centre


def sample_link(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    points, masses = rng.normal(size=(6, 3)) * 0.2, rng.uniform(0.1, 1.0, 6)
    centre = masses @ points / masses.sum()
    arms = points - centre
    about = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True))
    return combine_inertia(float(masses.sum()), centre, np.asarray(about))


@pytest.mark.parametrize("seed", range(5))
def test_zero_is_the_simulation(seed: int) -> None:
    link = sample_link(seed)
    assert LinkCoordinates(link).inertia(np.zeros(N_INERTIA)) == pytest.approx(link, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_every_value_is_matter(seed: int) -> None:
    """Mass is positive, and the moments of inertia about the centre obey the triangle inequality."""
    inertia = LinkCoordinates(sample_link(seed)).inertia(np.random.default_rng(seed).normal(size=N_INERTIA))
    mass, centre = to_centre(inertia)
    xx, xy, xz, yy, yz, zz = inertia[4:]
    about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    principal = np.linalg.eigvalsh(about - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre)))
    assert mass > 0.0
    assert principal[0] > 0.0
    assert principal[0] + principal[1] >= principal[2] * (1.0 - 1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_derivatives_are_those_of_the_values(seed: int) -> None:
    link, p = LinkCoordinates(sample_link(seed)), np.random.default_rng(seed).normal(size=N_INERTIA) * 0.3
    steps = 1e-6 * np.eye(N_INERTIA)
    numeric = np.stack([(link.inertia(p + e) - link.inertia(p - e)) / 2e-6 for e in steps], axis=1)
    assert link.jacobian(p) == pytest.approx(numeric, rel=1e-6, abs=1e-8)


def test_a_link_that_cannot_exist_becomes_the_nearest_that_can() -> None:
    impossible = combine_inertia(2.0, np.array([0.1, 0.0, 0.0]), np.diag([1.0, 0.1, 0.1]))
    inertia = LinkCoordinates(impossible).inertia(np.zeros(N_INERTIA))
    assert inertia[:4] == pytest.approx(impossible[:4])
    assert np.all(np.isfinite(inertia))
