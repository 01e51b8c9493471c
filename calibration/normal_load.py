"""Models identified under different normal loads, brought to one, so that their parameters compare.

A dry parameter p that holds at the load N_ref is worth p' = p (1 + k (N / N_ref - 1)) at N, and the sensitivity that
scales about N instead is k' = k N / N_ref / (1 + k (N / N_ref - 1)): both describe the same torque.
"""

from dataclasses import replace

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray, LoadScaling, Term
from fricomp.model import Covariance, FrictionModel

_DRY = ("coulomb_torque", "static_torque")


def own_load(model: FrictionModel) -> float | None:
    """The normal load under which a model was identified, in the unit of its loads; None where it is not known.

    That is its reference load, or the middle of the loads behind it where they do not reach there.
    """
    limits = model.validity.normal_load
    if limits is None:
        return None
    for _, load in _list_loaded_terms(model):
        if limits[0] <= load.reference_load <= limits[1]:
            return load.reference_load
    return 0.5 * (limits[0] + limits[1])


def at_normal_load(model: FrictionModel, load: float) -> FrictionModel:
    """The same model with parameters, and their covariance, that hold at `load`.

    Args:
        model: Its torque under every load stays as it is.
        load: In the unit of the model's loads.

    Raises:
        ParameterError: The law has no dry friction left under this load.
    """
    values, names = model.law.parameters(), model.covariance.names if model.covariance else ()
    changed: dict[str, float] = {}
    jacobian = np.eye(len(names))
    for term, scaling in _list_loaded_terms(model):
        ratio = load / scaling.reference_load
        factor = 1.0 + scaling.load_sensitivity * (ratio - 1.0)
        if factor <= 0.0:
            raise ParameterError(
                f"under a normal load of {load:g} the law of joint {model.joint!r} has no dry friction left, with a "
                f"sensitivity of {scaling.load_sensitivity:g} about {scaling.reference_load:g}: compare at another load"
            )
        k = f"{term.name}.load.load_sensitivity"
        dry = [name for name in values if name.startswith(f"{term.name}.") and name.rpartition(".")[2] in _DRY]
        changed |= {name: values[name] * factor for name in dry}
        changed |= {k: scaling.load_sensitivity * ratio / factor, f"{term.name}.load.reference_load": load}
        _differentiate(jacobian, names, {name: (factor, values[name] * (ratio - 1.0)) for name in dry}, k)
        if k in names:
            jacobian[names.index(k), names.index(k)] = ratio / factor**2
    return replace(model, law=model.law.replace(changed), covariance=_propagate(model.covariance, jacobian))


def _list_loaded_terms(model: FrictionModel) -> list[tuple[Term, LoadScaling]]:
    loads = [(term, getattr(term, "load", None)) for term in model.law.terms]
    return [(term, load) for term, load in loads if isinstance(load, LoadScaling)]


def _differentiate(
    jacobian: FloatArray, names: tuple[str, ...], slopes: dict[str, tuple[float, float]], sensitivity: str
) -> None:
    """Enter the slopes of dry parameters: by themselves, and by the sensitivity where it was identified."""
    for name, (by_itself, by_sensitivity) in slopes.items():
        if name not in names:
            continue
        row = names.index(name)
        jacobian[row, row] = by_itself
        if sensitivity in names:
            jacobian[row, names.index(sensitivity)] = by_sensitivity


def _propagate(covariance: Covariance | None, jacobian: FloatArray) -> Covariance | None:
    if covariance is None:
        return None
    matrix = jacobian @ covariance.matrix @ jacobian.T
    return replace(covariance, matrix=0.5 * (matrix + matrix.T))
