"""The compensation of one joint as functions of plain floats, generated once for a model and its settings.

Their text holds what this model and these settings need and nothing else, with the numbers written out and no branch
that cannot be taken. It is compiled from the library's own words and from numbers; no name of a file is ever in it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from numbers import Real
from typing import Any, Protocol

from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.compensation.hot_path_source import write_hot_path
from fricomp.control.settings import CompensationSettings
from fricomp.errors import ParameterError
from fricomp.laws.source import compile_python


class TorqueFunction(Protocol):
    """Compensation torque of one joint."""

    def __call__(
        self,
        velocity_reference: float,
        velocity: float | None = None,
        position_error: float | None = None,
        normal_load: float | None = None,
        position: float | None = None,
        load_torque: float | None = None,
        temperature: float | None = None,
        acceleration: float | None = None,
    ) -> float:
        """Torque to add to the command; 0.0 for a number that is not finite, or has no finite torque.

        So does a position, load torque or acceleration that the model depends on and that is not given. The 0.0 comes
        at once, whatever the rate of the settings.

        Args:
            velocity_reference: [rad/s] or [m/s].
            velocity: Measured [rad/s] or [m/s]; None where it is not measured.
            position_error: Reference minus measured position [rad] or [m].
            normal_load: Normal load, in the unit of the law's reference load.
            position: [rad] or [m]; used by terms over position.
            load_torque: Torque the joint transmits to its load; used by terms over load torque.
            temperature: [°C]; used by terms over temperature.
            acceleration: Of the reference [rad/s²] or [m/s²]; used by terms over acceleration.

        Raises:
            ParameterError: An input that is used is no number, such as an array, a text or a bool. It counts as
                rejected, too.
        """


@dataclass(frozen=True)
class HotPath:
    """A joint's closures.

    Attributes:
        torque: The compensation.
        reset: Forget state: bristle, lag, rests, rate limit. Not the counter.
        rejected: Number of inputs so far that were no finite number, or had no finite torque.
        rejection: Why the last of them was.
        set_scale: Multiply dry and viscous friction, for online adaptation.
        source: The text that they were compiled from.
    """

    torque: TorqueFunction
    reset: Callable[[], None]
    rejected: Callable[[], int]
    rejection: Callable[[], str]
    set_scale: Callable[[float, float], None]
    source: str


def build_hot_path(curves: FrictionCurves, settings: CompensationSettings, period: float) -> HotPath:
    """Generate the compensation for one joint; the equation is that of `CompensationSettings`.

    Args:
        curves: The law, taken apart.
        settings: How it is compensated.
        period: Control period [s].
    """
    lines = write_hot_path(curves, settings, period)
    build = compile_python(lines, "build", as_number=_as_number, ParameterError=ParameterError)
    torque, reset, rejected, rejection, set_scale = build()
    return HotPath(torque, reset, rejected, rejection, set_scale, "\n".join(lines))


def _as_number(name: str, value: Any) -> float:
    """`value` as a float; infinity for an integer beyond all floats.

    Raises:
        ParameterError: It is no number.
    """
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError:
            return inf
    raise ParameterError(
        f"{name} must be one number, got {value!r:.60} of type {type(value).__name__}: call torque with floats, once "
        "for each joint and sample; ArmCompensator.torque_into takes those of an arm, model.torque takes arrays"
    )
