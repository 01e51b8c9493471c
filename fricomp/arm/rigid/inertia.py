"""What a link weighs: ten numbers, and coordinates in which every value is a body that can exist.

    J = L_0 U(p) U(p)ᵀ L_0ᵀ,  L_0 L_0ᵀ = J_0,  U = upper triangular, exp(p_1..4) on its diagonal

J is the 4 × 4 pseudo-inertia of a link, J_0 that of the simulation. It is positive definite for every p, which is what
makes mass, first moments and moments of inertia those of matter [wensing2018]; p = 0 is the simulation, and p_i = 0.1
everywhere is a link some tenths off in mass, size and place, whatever the link is. So one number says how far a
simulation is trusted [rucker2022].
"""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray

N_INERTIA = 10
_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
_UPPER = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
_UPPER_ROWS, _UPPER_COLUMNS = np.array(_UPPER).T
_LEAST = 1e-3
"""Least axis of a pseudo-inertia, as part of its largest: a file may hold a link that cannot exist or has no extent."""

_LEAST_MASS, _LEAST_SIZE = 1e-3, 1e-2
"""[kg] and [m] of a link that the file gives no mass."""


def combine_inertia(mass: float, centre: FloatArray, about_centre: FloatArray) -> FloatArray:
    """Ten numbers of a body about an origin, from its mass [kg], centre [m] and inertia about that [kg·m²].

    Returns:
        m, h (3), I_xx, I_xy, I_xz, I_yy, I_yz, I_zz. Shape (10,).
    """
    about_origin = about_centre + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return np.array([mass, *(mass * centre), *(about_origin[i, j] for i, j in _PAIRS)])


def to_centre(inertia: FloatArray) -> tuple[float, FloatArray]:
    """Mass [kg] and centre of mass [m] of ten numbers."""
    mass = float(inertia[0])
    return mass, inertia[1:4] / max(mass, 1e-12)


def split_inertia(inertia: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Mass [kg], centre [m] and inertia about it [kg·m²] of ten numbers. Shapes (3,), (3, 3)."""
    mass, centre = to_centre(inertia)
    about = np.zeros((3, 3))
    for value, (i, j) in zip(inertia[4:], _PAIRS, strict=True):
        about[i, j] = about[j, i] = value
    return mass, centre, about - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))


def can_exist(inertia: FloatArray) -> bool:
    """Whether ten numbers are those of matter: positive mass, and spread in every direction [wensing2018]."""
    return float(inertia[0]) > 0.0 and float(np.linalg.eigvalsh(_to_pseudo(inertia))[0]) > 0.0


class LinkCoordinates:
    """Coordinates of one link, or of several at once, about its simulated inertia.

    Args:
        simulated: Ten numbers. Shape (10,), or (n_links, 10); so are all others.
    """

    def __init__(self, simulated: FloatArray) -> None:
        roots = [_find_root(_to_pseudo(one)) for one in np.atleast_2d(simulated)]
        self._root = np.stack(roots).reshape(*np.shape(simulated)[:-1], 4, 4)
        self._slopes = self._root[..., None, :, :] @ _DIRECTIONS

    def inertia(self, p: FloatArray) -> FloatArray:
        """Ten numbers at p. Shape (..., 10)."""
        root = self._root @ _to_factor(p)
        return _from_pseudo(root @ np.swapaxes(root, -1, -2))

    def jacobian(self, p: FloatArray) -> FloatArray:
        """Their derivatives by p. Shape (..., 10, 10)."""
        root = self._root @ _to_factor(p)
        scale = np.ones(np.shape(p))
        scale[..., :4] = np.exp(p[..., :4])
        half = (self._slopes * scale[..., None, None]) @ np.swapaxes(root, -1, -2)[..., None, :, :]
        return np.swapaxes(_from_pseudo(half + np.swapaxes(half, -1, -2)), -1, -2)


def _direction(i: int) -> FloatArray:
    result = np.zeros((4, 4))
    result[(i, i) if i < 4 else _UPPER[i - 4]] = 1.0
    return result


def _to_factor(p: FloatArray) -> FloatArray:
    """Shape (..., 4, 4)."""
    factor = np.zeros((*np.shape(p)[:-1], 4, 4))
    factor[..., range(4), range(4)] = np.exp(p[..., :4])
    factor[..., _UPPER_ROWS, _UPPER_COLUMNS] = p[..., 4:]
    return factor


def _to_pseudo(inertia: FloatArray) -> FloatArray:
    """[[Σ, h], [hᵀ, m]] with Σ = ½ tr(I) 1 - I, the second moments of the mass."""
    about = np.zeros((3, 3))
    for value, (i, j) in zip(inertia[4:], _PAIRS, strict=True):
        about[i, j] = about[j, i] = value
    result = np.zeros((4, 4))
    result[:3, :3] = 0.5 * np.trace(about) * np.eye(3) - about
    result[:3, 3] = result[3, :3] = inertia[1:4]
    result[3, 3] = inertia[0]
    return result


def _from_pseudo(pseudo: FloatArray) -> FloatArray:
    """Shape (..., 10)."""
    return np.asarray(pseudo.reshape(*pseudo.shape[:-2], 16) @ _FROM_PSEUDO.T)


def _tabulate() -> FloatArray:
    """The ten numbers as sums of the sixteen of a pseudo-inertia: I = tr(Σ) 1 - Σ. Shape (10, 16)."""
    table = np.zeros((N_INERTIA, 4, 4))
    table[0, 3, 3] = table[1, 3, 0] = table[2, 3, 1] = table[3, 3, 2] = 1.0
    for row, (i, j) in enumerate(_PAIRS, start=4):
        table[row, i, j] -= 1.0
        for k in range(3) if i == j else ():
            table[row, k, k] += 1.0
    return table.reshape(N_INERTIA, 16)


_FROM_PSEUDO = _tabulate()
_DIRECTIONS = np.stack([_direction(i) for i in range(N_INERTIA)])


def _find_root(pseudo: FloatArray) -> FloatArray:
    """A root of the nearest pseudo-inertia that matter can have: mass kept, second moments about the centre raised."""
    mass = max(float(pseudo[3, 3]), _LEAST_MASS)
    centre = pseudo[:3, 3] / mass
    values, axes = np.linalg.eigh(pseudo[:3, :3] - mass * np.outer(centre, centre))
    least = max(_LEAST * float(values[-1]), mass * _LEAST_SIZE**2)
    root = np.zeros((4, 4))
    root[:3, :3] = axes * np.sqrt(np.maximum(values, least))
    root[:3, 3], root[3, 3] = np.sqrt(mass) * centre, np.sqrt(mass)
    return root
