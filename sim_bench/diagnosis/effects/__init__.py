"""The catalogue of effects. Every module of this folder that defines one is found here by itself."""

from importlib import import_module
from pkgutil import iter_modules

from .effect import EFFECTS, Context, Effect, EffectParameter, Kind, register

__all__ = ["EFFECTS", "Context", "Effect", "EffectParameter", "Kind", "register"]

for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
