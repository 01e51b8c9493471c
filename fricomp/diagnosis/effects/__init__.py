"""The catalogue of effects, grouped by where they act. Every module of a group that defines one is found by itself."""

from importlib import import_module
from pkgutil import iter_modules, walk_packages

from .context import Context
from .effect import EFFECTS, Effect, EffectParameter, Kind, register

__all__ = ["EFFECTS", "Context", "Effect", "EffectParameter", "Kind", "register"]

_groups = [f"{__name__}.{module.name}" for module in iter_modules(__path__) if module.ispkg]
for _group in _groups:
    for _module in walk_packages(import_module(_group).__path__, f"{_group}."):
        import_module(_module.name)
for _name in sorted(EFFECTS):  # the order that the search sees does not hang on the folders
    EFFECTS[_name] = EFFECTS.pop(_name)
