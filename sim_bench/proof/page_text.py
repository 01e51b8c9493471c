"""What the pages of a proof say beside their figures."""

from __future__ import annotations

__all__ = ["CLEAR", "INJECTED", "INTRODUCTION", "LIMITS", "NULLS"]

INTRODUCTION = """# Proof on concealed cases

`fricomp bench mismatch` makes joints with physics that their simulation leaves out, has `fricomp diagnose` look at
recording, simulation and controller only, and compares. The generator (`sim_bench/concealed`) steps its own closed-loop
dynamics at 20 kHz, with friction cores, effects and sensors of its own, and imports neither the friction laws nor the
diagnosis; a test walks the imports.

Strength is the effect-to-noise ratio (ENR): the RMS of what a refit of everything the simulation already has leaves
of the concealed torque, over the noise, in 42 ms windows on noise-free data. The hash of each answer with its salt is
written to disk before the diagnosis of that case starts in another process and an empty folder. **That proves the
order of events, not independence**: generator and diagnosis come from one project. Scored seeds follow from the hash
of the committed diagnosis folder and the number of the run, so that they cannot be known while it is written; every
scored run is logged in `docs/proof/runs.jsonl` before it starts, so that abandoned ones show too.

The oracle beside the power is the likelihood-ratio test that knows every effect's shape, at the same ENR and length and
2 % false alarms over all effects together. Windows overlap by half, so that neighbours share 1/6 of white torque noise:
what changes slowly over them meets 4/3 of its variance, and 0.75 of their number count as independent. For effects that
change quickly, or where the encoder's noise leads, that is too few and the oracle stands too low; for coloured noise
too high.

A run (`--scored --page docs/proof.md`) goes in pieces: `--minutes M` starts no case after M minutes, finishes those
under way and writes the page, `--resume` goes on, in another checkout from the data beside this page. Groups, effects
and strengths are interleaved, so that any beginning is a fair sample of the whole; every scored run has an order of its
own. Up to the 25th, every effect met one friction core only, as lists turned side by side. A scored run refuses to go
on with another diagnosis or generator than it began with. `--replay N` diagnoses the cases of run N anew; with
`--verify` it makes their answers again and holds them against the seals without diagnosing. `--close "reason"` ends a
run, whose data moves to `run-N`.
`--nulls` runs joints with nothing missing alone ([300 of them](nulls.md)), `--clear` every effect once
([page](clear.md)), `--baselines N` compares other methods on the first N cases, `--speed-up N` times N cases with one
worker and with two, and [executors](fleet.md) are those of fleets.
"""
INJECTED = """# Effects injected into real recordings

`fricomp bench mismatch --injected` adds the torque that a known effect would have cost along the measured motion to
the torque channel of public recordings, and has `fricomp diagnose` look at the result blind, sealed as on simulated
joints. The noise, the friction and the flaws are those of real joints; the loop has not reacted to the effect.

Strength is what a refit of a rigid joint with a Stribeck curve for each direction leaves of the effect in 42 ms
windows, over what the same refit leaves of the recording itself. Before that the recordings are diagnosed as they are:
what is named there counts as known, is not injected, and is no false name afterwards. Recordings that come out
complete as they are stand apart from those in which more is missing already.
"""
CLEAR = """# Every effect of the catalogue once, clear

`fricomp bench mismatch --clear` conceals each effect of the catalogue in a joint at the clear strength, or as near to
it as the effect goes, on a rich motion of 30 s, with a joint from which nothing is missing after every third, and has
`fricomp diagnose` look at them blind. Generator, sealing, figures and what is not proved are those of the
[proof on concealed cases](proof.md); these are development seeds.
"""
NULLS = """# False alarms on joints with nothing missing

`fricomp bench mismatch --nulls` makes joints of which the simulation leaves nothing out, some of them with inertia,
gravity and friction other than the simulation says, and has `fricomp diagnose` look at them blind. Generator, sealing
and what is not proved are those of the [proof on concealed cases](proof.md).
"""
LIMITS = """## How the figures count

- "ENR ≥ x" begins at 0.95 x, as the search for an amplitude stops within 5 % of the wanted strength. Power, names and
  the confusion matrix (from ENR 0.5) are of one effect at a time.
- Right, too, are `torque_offset` for `direction_asymmetry` and the reverse, and unknown or `external_disturbance` for
  `neighbour_coupling`; some effects outside the catalogue may be called external.
- Names of parameters count as false where the simulation has that parameter right. Where inertia and gravity were
  shifted, `inertia_error` and `payload_error` are right.
- Pairs are of physics and measurement on a rich motion: no parameters, no pushes, no neighbours. Effects outside the
  catalogue are wanted at ENR 1 or more.
- Intervals of shares are exact for a number of cases that is fixed beforehand. Runs were ended after their errors had
  been read, for which no interval here makes up. Those of medians are order statistics; those of coverage and of the
  mean size of a set come from drawing whole cases again, as parameters of one case are not independent.
- Who holds the file of seals from before the diagnosis can check the order of events; everybody else is told it.

## What is not proved here

- Generator and diagnosis come from one project; effects that neither of them thinks of are not tried, beyond those
  outside the catalogue. Joints whose dynamics and left-out physics are MuJoCo's have
  [a page of their own](second_generator.md); they are not sealed.
- The joints are simulated, one hinge each. Effects injected into real recordings, with real noise, have
  [a page of their own](injected.md).
- Motion of a neighbouring joint is not logged, so that `neighbour_coupling` counts as right when it is called unknown
  or external.
- Strength of `presliding_hysteresis` is measured against the stiff bristle of the same joint; a diagnosis that fits
  the bristle's stiffness sees less of it.
- How much of the held-out gap is closed, of what the right structure could close, is not known for scored cases: the
  figure above counts from the diagnosis' own estimate of the noise, which is never above the error that its answer
  leaves, so that it is near 1 by construction and cannot be compared with the target of 0.95. What could be reached
  takes a second diagnosis without the concealed torque: `--gap N` does that on N cases of development seeds.
"""
