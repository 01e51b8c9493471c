"""Names and commands of cases, whichever way they are made."""

from __future__ import annotations

from ...cases import CaseSpec, case_id
from ..real.injection import InjectedSpec

__all__ = ["command_of", "name_of"]


def name_of(spec: CaseSpec | InjectedSpec) -> str:
    """A name that says nothing about what is concealed."""
    return spec.name if isinstance(spec, InjectedSpec) else case_id(spec)


def command_of(spec: CaseSpec | InjectedSpec) -> str:
    """The command that makes the case again."""
    if isinstance(spec, InjectedSpec):
        effect = f"--effect {spec.effect} --strength {spec.strength} " if spec.effect else ""
        return f"fricomp cases inject {spec.source} {effect}--seed {spec.seed} --out runs/cases"
    parts = ["fricomp cases make", f"--seed {spec.seed}", *(f"--effect {name}" for name in spec.effects)]
    parts += [f"--strength {spec.strength}", f"--excitation {spec.excitation}", f"--duration {spec.duration:g}"]
    for option in ("noise", "core", "family", "form", "fault"):
        value = getattr(spec, option)
        parts += [f"--{option} {value}"] if value else []
    parts += [f"--{flag}" for flag in ("shifted", "hidden") if getattr(spec, flag)]
    return " ".join([*parts, "--out runs/cases"])
