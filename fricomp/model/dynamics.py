"""What moves with a joint beside its friction: with it a model file predicts torque and motion by itself."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.laws.term import require_finite, require_nonnegative, require_positive


@dataclass(frozen=True)
class JointDynamics:
    """The rest of the equation of motion: tau = J a + g_c cos(q) + g_s sin(q) + tau_0 + friction.

    A linear joint has its whole constant load in tau_0.

    Attributes:
        inertia: J [kg·m²] or [kg]; in the model's own torque unit times s² over the position unit otherwise.
        gravity_cosine: g_c [N·m].
        gravity_sine: g_s [N·m].
        offset: tau_0 [N·m] or [N].
        load_inertia: Part of the inertia behind the gear [kg·m²] or [kg]: the gear transmits gravity and what it
            accelerates.
        torque_delay: Time by which the torque of the recordings was late [s].

    Raises:
        ParameterError: A number is not finite, the inertia is not positive, or it is smaller than its part.
    """

    inertia: float
    gravity_cosine: float = 0.0
    gravity_sine: float = 0.0
    offset: float = 0.0
    load_inertia: float = 0.0
    torque_delay: float = 0.0

    def __post_init__(self) -> None:
        require_positive(self, "inertia")
        require_nonnegative(self, "load_inertia")
        require_finite(self, "gravity_cosine", "gravity_sine", "offset", "torque_delay")
        if self.load_inertia > self.inertia:
            raise ParameterError(f"load_inertia {self.load_inertia:g} must not exceed the inertia {self.inertia:g}")

    def compute_gravity(
        self, position: FloatArray, recall: Callable[[], tuple[FloatArray, FloatArray]] | None = None
    ) -> FloatArray:
        """Torque of gravity, without the offset [N·m]. Shape (n,).

        Args:
            position: Where [rad]. Shape (n,).
            recall: Gives cosine and sine there, where they are kept; None to work them out.
        """
        if self.gravity_cosine == 0.0 and self.gravity_sine == 0.0:
            return np.zeros_like(position)
        cosine, sine = (np.cos(position), np.sin(position)) if recall is None else recall()
        result: FloatArray = self.gravity_cosine * cosine + self.gravity_sine * sine
        return result

    def compute_load(self, position: FloatArray, acceleration: FloatArray) -> FloatArray:
        """Torque that the gear transmits to the load [N·m]. Shape (n,)."""
        result: FloatArray = self.compute_gravity(position) + self.load_inertia * acceleration
        return result

    def units(self, torque_unit: str, position_unit: str) -> dict[str, str]:
        """The unit of each number."""
        inertia = {"N·m·s²/rad": "kg·m²", "N·s²/m": "kg"}
        unit = f"{torque_unit}·s²/{position_unit}"
        whole = inertia.get(unit, unit)
        torques = dict.fromkeys(("gravity_cosine", "gravity_sine", "offset"), torque_unit)
        return {"inertia": whole, "load_inertia": whole, "torque_delay": "s", **torques}
