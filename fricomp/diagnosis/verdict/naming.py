"""The effects as they are named: a pure function of the evidence."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

from ..effects import EFFECTS
from ..effects.spring import SPRING, SPRING_CHANGE
from ..evidence.comparison import Shift
from ..evidence.effect_evidence import EffectEvidence
from ..evidence.findings import Findings
from ..evidence.in_place import BODY_SHIFTS
from ..evidence.settings import NEEDS
from ..inputs.rigid import Spring
from ..record.result import Change, Kind, Location, NamedEffect, Quantity
from ..samples.sample_finding import SampleFinding

_GAIN, _OFFSET = "torque_gain_error", "torque_offset"
_NO_CENTRE = "its centre is not determined, since that of a straight one is a constant torque"


class SpringWords(NamedTuple):
    """A spring as the recording shows it: fields of a named effect."""

    kind: Kind
    parameters: dict[str, Quantity]
    sentence: str
    equation: str


def name_effects(findings: Findings, explained: float) -> tuple[NamedEffect, ...]:
    """Name what the rows show, strongest first.

    Args:
        findings: Evidence from the rows.
        explained: Part of the energy above the noise that the effects share.
    """
    shifts = _list_shifts(findings)
    own = [one for one in findings.effects if one.overtone_of is None]
    named = [_name_chosen(findings, one, shifts.get(one.effect.name), explained) for one in own]
    names, parts = [one.name for one in named], findings.parts or (0.0,) * len(shifts)
    named += [
        _name_shift(findings, shift, explained * part, findings.location if findings.as_given else {})
        for shift, part in zip(shifts.values(), parts, strict=False)
        if shift.name not in names
    ]
    named += [] if findings.lag is None else [_name_shift(findings, findings.lag, 0.0, {})]
    return tuple(sorted(named, key=lambda effect: -effect.share))


def _list_shifts(findings: Findings) -> dict[str, Shift]:
    """Shifts that may be named, by name: an unexplained residual biases the fitted parameters, so none is then.

    Beside an effect that scales the torque by a factor of its own no gain is named: how the two share it is a matter
    of form. Nor is a constant torque beside a spring, which has one where its centre is not at zero.
    """
    own = [one.effect for one in findings.effects if one.overtone_of is None]
    taken = {_GAIN} if any(effect.scales_torque for effect in own) else set[str]()
    taken |= {_OFFSET} if any(effect.name == SPRING for effect in own) else set()
    shifts = () if findings.unknown else findings.comparison.shifts
    stay = [shift for shift in shifts if comes_again(findings.shift_shares, _list_names(shift))]
    return {shift.name: shift for shift in stay if shift.name not in taken}


def _list_names(shift: Shift) -> set[str]:
    """Names under which a shift may come again: inertia and gravity are off whichever name a part of the recording
    gives that."""
    return {shift.name, *shift.alike} | (set(BODY_SHIFTS) if shift.name in BODY_SHIFTS else set())


def comes_again(shares: Mapping[str, float], names: Collection[str]) -> bool:
    """Whether a shift under any of its names comes again as often as a name must; where nobody asked, it does."""
    return not shares or sum(shares.get(name, 0.0) for name in names) >= NEEDS.share


def _name_chosen(findings: Findings, one: EffectEvidence, same: Shift | None, explained: float) -> NamedEffect:
    """An effect of the chosen explanation, with what the comparison says under `same` name.

    So it is with a load that differs between the recordings, and in the first of them from the simulation's. Which of
    two laws draws a ripple and which its overtone is a matter of the fit.
    """
    effect, all_energy = one.effect, sum(each.energy for each in findings.effects)
    drawn = [e for e in findings.effects if e.overtone_of is not None and e.overtone_of.name == effect.name]
    tones = [e.overtone_of.order for e in drawn if e.overtone_of is not None]
    says, equation, numbers = _print_form(findings, one)
    says += "".join(f"; its form shows at the order {order:.4g} too" for order in tones)
    words = SpringWords(effect.kind, numbers, says, equation)
    if effect.name == SPRING:
        words = describe_spring(words, findings.case.spring)
    energy = one.energy + sum(each.energy for each in drawn)
    return NamedEffect(
        name=effect.name,
        kind=words.kind,
        parameters=words.parameters | (same.parameters if same is not None else {}),
        indistinguishable_from=tuple(dict.fromkeys([*one.aliases, *(each.effect.name for each in drawn)])),
        location=one.location,
        share=explained * energy / max(all_energy, 1e-30),
        equation=words.equation,
        sentence=words.sentence if same is None else f"{words.sentence}; {same.sentence}",
        citation=effect.citation,
    )


def _print_form(findings: Findings, one: EffectEvidence) -> tuple[str, str, dict[str, Quantity]]:
    """What an effect says in the form that was found, its equation there, and the numbers that stand in it."""
    values = {name: quantity.value for name, quantity in one.parameters.items()}
    chosen, unit, position = findings.chosen, findings.case.unit, findings.case.position_unit
    form = None if chosen is None else one.effect.choose_form(values, chosen.structure.contexts)
    if form is None:
        return one.effect.says, one.effect.equation, one.parameters
    numbers = {}
    for name, (factor, of) in form.numbers.items():
        if name in one.parameters:
            fitted = one.parameters[name]
            low, high = fitted.ci95
            printed = of.replace("{torque}", unit).replace("{position}", position)
            numbers[name] = Quantity(factor * fitted.value, printed, (factor * low, factor * high), fitted.at_bound)
    return form.says, form.equation, numbers


def _name_shift(findings: Findings, shift: Shift, share: float, location: Location) -> NamedEffect:
    """A moved parameter; inertia and gravity with the effects that explain as much."""
    instead = findings.case.instead if shift.name in BODY_SHIFTS else ()
    return shift.to_effect(share, location, instead)


def name_late_action(findings: Findings) -> NamedEffect:
    """The torque that was moved to where it acts before the base was fitted."""
    effect = EFFECTS["torque_delay"]
    return NamedEffect(
        name=effect.name,
        kind=effect.kind,
        parameters={"delay": findings.late_action},
        indistinguishable_from=("drive_lag",),
        equation="tau(t) = tau_recorded(t - T_d)",
        sentence="the torque acts later than its stamp says, by a delay or by a low pass of a high order",
        citation=effect.citation,
    )


def name_sample(sample: SampleFinding) -> NamedEffect:
    """What the samples show; its share is counted in them."""
    return NamedEffect(
        name=sample.name,
        kind=sample.kind,
        parameters=sample.parameters,
        indistinguishable_from=sample.alike,
        share=sample.held.explained,
        equation=sample.equation,
        sentence=sample.sentence,
        citation=sample.citation,
    )


def describe_spring(words: SpringWords, given: Spring | None) -> SpringWords:
    """Say of a spring what the recording shows of it.

    The centre of a straight one is an offset, which the base has as well: no recording tells the two apart, and an
    interval of it would be one of the steps by which the fit's derivatives are taken. A spring beside the
    simulation's own is a parameter of that one.

    Args:
        words: As it was fitted: the stiffness is the difference.
        given: Of the simulation; None where it has no spring.
    """
    if words.parameters["hardening"].ci95[0] > 0.0:  # the simulation has no term by which its own would stiffen so
        beside = "" if given is None else ", beside that of the simulation"
        return words._replace(sentence=words.sentence + beside)
    rest = {name: one for name, one in words.parameters.items() if name != "centre"}
    if given is None:
        return words._replace(parameters=rest, sentence=f"{words.sentence}; {_NO_CENTRE}")
    change = rest.pop("stiffness")
    whole, unit = _add_stiffness(change, given), change.unit
    if whole.ci95[0] <= 0.0:
        sentence = f"the simulation has a spring of {given.stiffness:.4g} {unit} that the joint does not show"
    else:
        sentence = f"the joint's spring has {whole.value:.4g} {unit}, that of the simulation {given.stiffness:.4g}"
    return SpringWords("parameter", {"stiffness_change": change, **rest}, sentence, "")


def compare_spring(effects: Sequence[NamedEffect], given: Spring | None) -> tuple[Change, ...]:
    """List the stiffness of the simulation and of the joint, where the two were found to differ."""
    if given is None:
        return ()
    changes = (one.parameters.get("stiffness_change") for one in effects if one.name == SPRING)
    return tuple(
        Change(name=SPRING_CHANGE, given=given.stiffness, refitted=_add_stiffness(one, given)) for one in changes if one
    )


def _add_stiffness(change: Quantity, given: Spring) -> Quantity:
    low, high = change.ci95
    return Quantity(given.stiffness + change.value, change.unit, (given.stiffness + low, given.stiffness + high))
