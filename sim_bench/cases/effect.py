"""What an effect is to the generator: fields of plant, sensors or belief as a function of one amplitude."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import DiagnosisError

from .joint import Joint

Kind = Literal["physics", "measurement", "parameter", "outside", "signal"]


@dataclass(frozen=True)
class Scene:
    """The joint and the motion that an effect is put into.

    Attributes:
        joint: Without effects.
        time: Since the start of the recording [s]; negative in the lead-in. Shape (n_samples,).
        reference: Position [rad] and velocity [rad/s], shape (n_samples, 2).
    """

    joint: Joint
    time: NDArray[np.float64]
    reference: NDArray[np.float64]

    @property
    def coulomb(self) -> float:
        """Mean Coulomb torque [N·m]."""
        return 0.5 * (self.joint.fields["coulomb_forward"] + self.joint.fields["coulomb_reverse"])

    @property
    def viscous(self) -> float:
        """Mean viscous coefficient [N·m·s/rad]."""
        return 0.5 * (self.joint.fields["viscous_forward"] + self.joint.fields["viscous_reverse"])

    @property
    def inertia(self) -> float:
        """[kg·m²]"""
        return self.joint.fields["inertia"]

    @property
    def gravity(self) -> float:
        """Largest gravity torque [N·m]."""
        return self.joint.fields["gravity"]

    @property
    def load(self) -> float:
        """A typical load torque of this motion [N·m]."""
        return self.gravity + self.inertia * 2.0


@dataclass(frozen=True)
class Truth:
    """A true parameter under the catalogue's name, or under one of its own where the form is another."""

    value: float
    unit: str


@dataclass(frozen=True)
class Change:
    """What an effect sets.

    Attributes:
        plant: Fields of the plant.
        sensing: Fields of `fricomp.sim_bench.cases.sensing.Sensors`.
        belief: Fields of the joint as the user's simulation has them, where they differ from the truth.
        disturbance: Torque from outside [N·m], positive against forward motion; shape (n_samples,).
        temperature: Of the joint [°C].
        factor: On the dry friction [1].
        parameters: True values.
    """

    plant: dict[str, float] = field(default_factory=dict)
    sensing: dict[str, float] = field(default_factory=dict)
    belief: dict[str, float] = field(default_factory=dict)
    disturbance: NDArray[np.float64] | None = None
    temperature: NDArray[np.float64] | None = None
    factor: NDArray[np.float64] | None = None
    parameters: dict[str, Truth] = field(default_factory=dict)


@dataclass(frozen=True)
class Form:
    """One functional form of an effect.

    Attributes:
        name: Of the form.
        build: Change that an amplitude makes in a scene; it draws the same numbers at every amplitude.
        shared: The catalogue has this form, so its parameters can be compared directly.
    """

    name: str
    build: Callable[[Scene, float, np.random.Generator], Change]
    shared: bool = True


@dataclass(frozen=True)
class Effect:
    """An effect that can be concealed.

    Attributes:
        name: The catalogue's, or the generator's own outside of it.
        kind: As in the catalogue; `outside` where the catalogue has no such thing.
        forms: One or more.
        typical: Smallest and largest amplitude seen on real joints, in the forms' own unit, given the scene.
        localised: Its energy sits in a part of the recording.
        against: What the strength is measured after: `refit` of everything, of `friction` only, or `nothing`.
        accepted: Other answers that are right too.
        smallest: Amplitude at which nothing is left of the effect, given the scene; a thousandth of the
            smallest typical one by default.
    """

    name: str
    kind: Kind
    forms: tuple[Form, ...]
    typical: Callable[[Scene], tuple[float, float]]
    localised: bool = False
    against: Literal["refit", "friction", "nothing"] = "refit"
    accepted: tuple[str, ...] = ()
    smallest: Callable[[Scene], float] | None = None

    def floor(self, scene: Scene) -> float:
        """Amplitude [as `typical`] at which nothing is left of the effect to speak of."""
        return self.smallest(scene) if self.smallest else 1e-3 * self.typical(scene)[0]


_SWITCHES = {"flexible"}


def _add(first: NDArray[np.float64] | None, second: NDArray[np.float64] | None) -> NDArray[np.float64] | None:
    if first is None or second is None:
        return first if second is None else second
    return np.asarray(first + second)


def merge(first: Change, second: Change) -> Change:
    """Both changes at once; a switch set by both stays on.

    Raises:
        DiagnosisError: Both set the same part of the joint, such as the stiffness of its transmission.
    """
    if clash := sorted((first.plant.keys() & second.plant.keys()) - _SWITCHES):
        raise DiagnosisError(f"two effects set the same part of the joint ({', '.join(clash)}): conceal one of them")
    factor = second.factor if first.factor is None else first.factor
    if first.factor is not None and second.factor is not None:
        factor = first.factor * second.factor
    return Change(
        plant=first.plant | second.plant,
        sensing=first.sensing | second.sensing,
        belief=first.belief | second.belief,
        disturbance=_add(first.disturbance, second.disturbance),
        temperature=second.temperature if first.temperature is None else first.temperature,
        factor=factor,
        parameters=first.parameters | second.parameters,
    )
