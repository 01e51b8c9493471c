"""All effects that the generator can conceal, by name."""

from ..effect import Effect
from . import drive, friction, load, measurement, outside, parameter, position, transmission

__all__ = ["CATALOGUE", "EFFECTS", "OUTSIDE"]

EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for module in (friction, load, position, transmission, drive, measurement, parameter, outside)
    for effect in module.EFFECTS
}
OUTSIDE: dict[str, Effect] = {name: effect for name, effect in EFFECTS.items() if effect.kind == "outside"}
CATALOGUE: dict[str, Effect] = {name: effect for name, effect in EFFECTS.items() if effect.kind != "outside"}
