"""An effect that a joint can have, and how joints with one are built."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from .hidden import Hidden
from .joint import JOINT, JointParts
from .law import Law
from .motion import Motion

Group = Literal["nothing", "parameter", "measurement", "physics", "outside"]


@dataclass(frozen=True)
class Effect:
    """An effect that a joint can have.

    Attributes:
        group: What it is.
        name: As the diagnosis calls it; for one that is not in its catalogue a name of its own.
        how: What MuJoCo does.
        build: The joint for a motion.
        right: Names that are right besides its own.
        form_of: Effect of the catalogue of which it is another form; empty where it is none.
    """

    group: Group
    name: str
    how: str
    build: Callable[[Motion], Hidden]
    right: tuple[str, ...] = ()
    form_of: str = ""

    @property
    def called(self) -> str:
        """Its name in the catalogue."""
        return self.form_of or self.name

    @property
    def names(self) -> frozenset[str]:
        """Names that a diagnosis may give."""
        own = {self.called} if self.group not in ("nothing", "outside") else set()
        return frozenset({*own, *self.right})


def always(hidden: Hidden) -> Callable[[Motion], Hidden]:
    """The same joint whatever the motion."""
    return lambda motion: hidden


def written(make: Callable[[], Law], truth: Mapping[str, float] | None = None) -> Callable[[Motion], Hidden]:
    """The plain joint with a law that is written at every step."""
    return always(Hidden(law=make, truth=truth or {}))


def built_of(parts: JointParts, truth: Mapping[str, float] | None = None) -> Callable[[Motion], Hidden]:
    """A joint of other parts."""
    return always(Hidden(parts=parts, truth=truth or {}))


def motor(attributes: str, element: str = "motor") -> JointParts:
    """The plain joint with another motor."""
    return JointParts(actuator=f'<{element} name="{JOINT}" joint="{JOINT}" {attributes}/>')
