"""Every effect by its name."""

from .effect import Effect, always
from .flaws import FLAWS
from .forms import FORMS
from .hidden import Hidden
from .outside import OUTSIDE
from .physics import PHYSICS

_NOTHING = Effect("nothing", "nothing", "the plain joint", always(Hidden()))

EFFECTS = {effect.name: effect for effect in (_NOTHING, *PHYSICS, *FLAWS, *OUTSIDE, *FORMS)}
"""Every effect by its name."""
