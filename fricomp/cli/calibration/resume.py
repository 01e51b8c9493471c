"""`fricomp calibrate --resume`: what may be asked for otherwise, and what a run keeps as it was begun."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from fricomp.errors import ParameterError

if TYPE_CHECKING:
    from fricomp.calibration.sweep import CalibrationRequest

RESUMABLE = ("normal_load", "method", "noise")
"""Options that change what is made of a sweep, not the sweep."""

_ELSEWHERE = ("seed", "backend")  # of a configuration: options of their own


def changes(asked: CalibrationRequest, given: Iterable[str]) -> dict[str, Any]:
    """Those of `RESUMABLE` that stand on the command line, by name."""
    told = _told(asked)
    return {name: told[name] for name in RESUMABLE if name in given}


def refuse_other(asked: CalibrationRequest, stored: CalibrationRequest, given: Iterable[str]) -> None:
    """Refuse options that a resumed run would ignore; those that say what it was begun with do no harm.

    Args:
        asked: By the command line.
        stored: With the run.
        given: Names of the options that stand on the command line.

    Raises:
        ParameterError: There are some.
    """
    now, begun = _told(asked), _told(stored)
    refused = sorted(n for n in given if n not in RESUMABLE and (n not in now or now[n] != begun[n]))
    if refused:
        raise ParameterError(
            f"--resume goes on with the run as it was begun, so {flags(refused)} cannot be changed: leave "
            f"{'it' if len(refused) == 1 else 'them'} out; only {flags(RESUMABLE)} may be given anew"
        )


def flags(names: Iterable[str]) -> str:
    """Options as they are typed."""
    return ", ".join(f"--{name.replace('_', '-')}" for name in names)


def _told(request: CalibrationRequest) -> dict[str, Any]:
    """What a request says, by the names of the options."""
    settings, options = request.settings, request.options
    return {name: getattr(settings, name) for name in settings.__dataclass_fields__} | {
        "backend": request.backend,
        "config": {name: value for name, value in request.configuration.items() if name not in _ELSEWHERE},
        "joint": request.joint,
        "model": request.model,
        "motion": request.motion,
        "gravity_unknown": options.gravity_unknown,
        "adaptive": options.adaptive,
        "accuracy": options.accuracy,
        "normal_load": options.normal_load,
        "method": options.identification.method,
        "noise": options.identification.noise,
    }
