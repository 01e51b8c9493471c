"""What the catalogue's form comes closest with, where the concealed one has another form.

A least-squares fit of the concealed torque on noise-free data, by the catalogue's regressors beside the rigid joint's.
Effects whose catalogue form is not linear in its parameters have no such value here.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from .dynamics import Motion
from .effect import Truth
from .refit import compute_weak_form
from .strength import Concealed
from .trial import Outcome

_Columns = Mapping[str, "NDArray[np.float64]"]


def _load(motion: Motion, given: Mapping[str, Truth]) -> _Columns:
    return {"coefficient": np.abs(motion.load) * motion.sense}


def _build_wave(motion: Motion, given: Mapping[str, Truth]) -> _Columns:
    angle = given["order"].value * motion.position
    return {"sine": np.sin(angle) * motion.sense, "cosine": np.cos(angle) * motion.sense}


def _describe_ripple(motion: Motion, given: Mapping[str, Truth]) -> _Columns:
    angle = given["order"].value * motion.position
    return {"sine": np.sin(angle), "cosine": np.cos(angle)}


def _build_saturation(motion: Motion, given: Mapping[str, Truth]) -> _Columns:
    return {"coefficient": motion.torque**3}


_FITS: dict[str, Callable[[Motion, Mapping[str, Truth]], _Columns]] = {
    "load_coulomb": _load,
    "position_coulomb": _build_wave,
    "cogging": _describe_ripple,
    "torque_saturation": _build_saturation,
}


def fit_catalogue(concealed: Concealed, outcome: Outcome) -> dict[str, Truth]:
    """Best-fitting values of the catalogue's parameters by name; empty where the form cannot be fitted this way."""
    given = concealed.change.parameters
    if concealed.effect.name not in _FITS:
        return {}
    columns = _FITS[concealed.effect.name](outcome.motion, given)
    rows = outcome.rows
    wanted = compute_weak_form(concealed.torque) / rows.deviation
    own = np.stack([compute_weak_form(values) / rows.deviation for values in columns.values()], axis=1)
    everything = np.hstack([own, rows.friction, rows.body])
    scale = np.linalg.norm(everything, axis=0)
    scale[scale == 0.0] = 1.0
    solution = np.linalg.lstsq(everything / scale, wanted, rcond=1e-9)[0] / scale
    found = {name: Truth(float(solution[i]), given[name].unit) for i, name in enumerate(columns)}
    return {name: truth for name, truth in given.items() if name == "order"} | found
