"""Every effect by its name."""

from fricomp.errors import DiagnosisError

from .effect import Effect, always
from .flaws import FLAWS
from .forms import FORMS
from .hidden import Hidden
from .outside import OUTSIDE
from .physics import PHYSICS

_NOTHING = Effect("nothing", "nothing", "the plain joint", always(Hidden()))

EFFECTS = {effect.name: effect for effect in (_NOTHING, *PHYSICS, *FLAWS, *OUTSIDE, *FORMS)}
"""Every effect by its name."""


def find_effect(name: str) -> Effect:
    """The effect of a name.

    Raises:
        DiagnosisError: There is none.
    """
    if name not in EFFECTS:
        raise DiagnosisError(f"no effect {name!r}: valid are {', '.join(EFFECTS)}")
    return EFFECTS[name]
