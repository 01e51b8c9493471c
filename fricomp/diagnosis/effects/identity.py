"""Effects that are the same torque as another one beside the base, on every motion: known by algebra.

With s = sgn(v), friction under load is

    |tau_l| s = 2 |tau_l| [tau_l v > 0] s - tau_l,

for where the joint drives both sides are tau_l s s = tau_l, and where it brakes both are -tau_l; in the same way it is
2 |tau_l| [tau_l v < 0] s + tau_l. The load tau_l is made of gravity and inertia, which the base has: where no
simulation says these, friction under load and friction of driving or of braking alone are one torque with three names.
A test finds the same pairs by the rank of all columns at points where nothing is special.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

DRIVING, BRAKING = 1, 2
"""Forms of friction that is there in one of both cases alone."""


class Identity(NamedTuple):
    """Two effects that are one torque, but for gravity and inertia.

    Attributes:
        one: The effect that comes first where no simulation decides.
        other: The other effect.
        form: Name of the parameter of the other effect that makes it `DRIVING` or `BRAKING`.
        equation: Why they are the same.
    """

    one: str
    other: str
    form: str
    equation: str

    def holds(self, values: Mapping[str, float]) -> bool:
        """Whether these values of the other effect are of such a form."""
        return self.choose_form(values) in (DRIVING, BRAKING)

    def choose_form(self, values: Mapping[str, float]) -> int:
        """The form of the other effect that these values stand for."""
        return round(values.get(self.form, DRIVING))


IDENTITIES = (
    Identity(
        one="load_coulomb",
        other="load_quadratic",
        form="split",
        equation="|tau_l| s = 2 |tau_l| [tau_l v > 0] s - tau_l = 2 |tau_l| [tau_l v < 0] s + tau_l",
    ),
)


def find_identity(values: Mapping[str, Mapping[str, float]]) -> Identity | None:
    """The identity by which two of these effects are one; None where there is none.

    Args:
        values: Parameters by effect and name.
    """
    for identity in IDENTITIES:
        if identity.one in values and identity.other in values and identity.holds(values[identity.other]):
            return identity
    return None


class Twin(NamedTuple):
    """The same torque under the name that comes first.

    Attributes:
        identity: Why they are the same.
        values: Parameters of the effect that comes first.
        gravity: Factor on gravity and inertia beside it.
    """

    identity: Identity
    values: dict[str, float]
    gravity: float


def find_twin(values: Mapping[str, Mapping[str, float]], usual_load: float) -> Twin | None:
    """The same torque by an effect that comes first; None where these have no such effect.

    With k = c_d of driving, or k = -c_b of braking, the same torque has gravity and inertia 1 + k/2 times as large and
    friction under load of c = |k| / (2 + k).

    Args:
        values: Parameters by effect and name.
        usual_load: By which the coefficient of driving or braking is counted [N·m].
    """
    for identity in IDENTITIES:
        own = values.get(identity.other, {})
        if not own or identity.one in values or not identity.holds(own):
            continue
        coefficient = own["coefficient"] * usual_load
        level = 0.5 * coefficient
        gravity = 1.0 + (level if identity.choose_form(own) == DRIVING else -level)
        if level > 0.0 and gravity > 0.0:
            rest = {name: value for name, value in own.items() if name not in ("coefficient", identity.form)}
            return Twin(identity, {"coefficient": level / gravity, **rest}, gravity)
    return None
