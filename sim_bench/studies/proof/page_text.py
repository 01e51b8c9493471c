"""What the pages of a proof say beside their figures."""

from __future__ import annotations

__all__ = ["CLEAR", "HOW_A_RUN_GOES", "INJECTED", "INTRODUCTION", "LIMITS", "NULLS"]

INTRODUCTION = """# Proof on concealed cases

`fricomp bench mismatch` makes joints with physics that their simulation leaves out, has `fricomp diagnose` look at
recording, simulation and controller only, and compares. The generator (`sim_bench/cases`) steps its own
closed-loop dynamics at 20 kHz, with friction cores, effects and sensors of its own, and imports neither the friction
laws nor the diagnosis; a test walks the imports. Nearly every second simulation beside an effect is wrong in inertia,
gravity (2 to 25 %) and centre of mass as well; every second case comes with the friction of the joint without the
effect.

Strength is the effect-to-noise ratio (ENR): what a refit of inertia, gravity, offset and both Stribeck curves leaves
of the concealed torque in windows of 42 ms, over the noise of such a window, root mean square. The hash of each
answer is on disk before the diagnosis of that case starts, in a process and folder of its own. **That is an order of
events, no independence**: generator and diagnosis come from one project. [How a run
goes](proof/details.md#how-a-run-goes) tells the rest.
"""
HOW_A_RUN_GOES = """## How a run goes

**Sealing.** The hash of each answer with its salt is written to `docs/proof/seals.jsonl` before the diagnosis starts.
It proves the order to whoever has kept that file from before; in the repository seals and scores come together, and
everybody else is told. Scored seeds follow from the hash of the committed diagnosis folder and the number of the run,
so that they cannot be known while it is written; every scored run is logged in `docs/proof/runs.jsonl` before it
starts, so that abandoned ones show too. `docs/proof/answers.parquet` holds each answer that was opened, as it was
sealed, beside what was said, first and with the motion that was proposed: anybody can score them by rules of their
own.

**In pieces.** This page is written by

    fricomp bench mismatch --scored --cases 2000 --minutes 60 --resume --page docs/proof.md --out runs/scored

where `--minutes M` starts no case after M minutes, finishes those under way and writes the pages, and `--resume` goes
on, in another checkout from the data beside the page. A scored run keeps to the number of cases that it began with,
and refuses to go on with another diagnosis, generator or plan. Groups, effects and strengths are interleaved, so that
any beginning is a fair sample of the whole; every scored run has an order of its own. `fricomp bench mismatch-replay
N` diagnoses the cases of run N anew, where its `run.json` is kept; with `--verify` it makes their answers again and
holds them against the seals without diagnosing. `fricomp bench mismatch-close "reason"` ends a run, whose data moves to
`run-N`.

**On another processor.** Processors round differently, and a joint that sticks and slides lets a last digit grow, so
that an answer made again on another kind of processor has another hash: `--verify` then asks whether the kept answer
has the hash that was sealed and tells the same, each name and each value within 5 %. A case that a stop left without a
diagnosis, and that is made again elsewhere, gets a second line among the seals, which counts; the first stays.

**Strength.** Five effects would vanish in the refit and are measured against what the user states: errors of gain,
inertia and payload after a refit of friction alone, an offset and a difference between directions after none.

**Oracle.** Beside the power stands that of the likelihood-ratio test that knows every effect's shape, at the same ENR
and length, with 2 % false alarms over all effects together. It counts three quarters of the windows as independent,
since they overlap by half. That is too few for effects that change quickly, and too many under coloured noise.

**Other calls.** `--nulls` runs joints with nothing missing alone, `--clear` every effect once ([page](../clear.md)),
`--baselines N` compares other methods on the first N cases. `fricomp bench mismatch-gap` measures how much of the
held-out error is closed, `mismatch-speed-up` times cases with one worker and with two, and
[executors](../fleet.md) are those of fleets.
"""
INJECTED = """# Effects injected into real recordings

`fricomp bench mismatch --injected` adds the torque that a known effect would have cost along the measured motion to
the torque channel of public recordings, and has `fricomp diagnose` look at the result blind, sealed as on simulated
joints. The noise, the friction and the flaws are those of real joints; the loop has not reacted to the effect.

Strength is what a refit of a rigid joint with a Stribeck curve for each direction leaves of the effect in 42 ms
windows, over what the same refit leaves of the recording itself. Before that the recordings are diagnosed as they
are: what is named there counts as known, is not injected, and is no false name afterwards. Recordings that come out
complete as they are stand apart from those in which more is missing already. Cases of one recording are alike, so
that intervals of shares take each recording as one cluster.
"""
CLEAR = """# Every effect of the catalogue once, clear

`fricomp bench mismatch --clear` conceals each effect of the catalogue in a joint at the clear strength, or as near to
it as the effect goes, on a rich motion of 30 s, with a joint from which nothing is missing after every third, and has
`fricomp diagnose` look at them blind. Every simulation is right otherwise. Generator, sealing, figures and what is
not proved are those of the [proof on concealed cases](proof.md); these are development seeds.
"""
NULLS = """# False alarms on joints with nothing missing

`fricomp bench mismatch --nulls` makes joints of which the simulation leaves nothing out, some of them with inertia,
gravity and friction other than the simulation says, and has `fricomp diagnose` look at them blind. Generator, sealing
and what is not proved are those of the [proof on concealed cases](proof.md).
"""
LIMITS = """## What the words mean

| word | meaning |
|---|---|
| single, pair, triple | so many effects of the catalogue in one joint |
| null, hard null | nothing is missing; of a hard null the simulation has inertia and gravity wrong |
| outside | an effect that the catalogue does not hold |
| hidden | load and temperature, on which the effect depends, are not logged |
| fault | a signal that contradicts itself, such as a flipped torque |
| clear | an ENR of 8, or as near to it as the effect goes |
| core | how the joint sticks: Dahl or LuGre bristle, Maxwell-slip elements (`gms`), or with no travel (`set_valued`) |
| set | a name with what the answer says it cannot be told from |
| false name | neither concealed nor accepted for what is, and with nothing concealed in its set |
| open | the 95 % interval reaches beyond the target, whatever the value says |

## How the figures count

- "ENR ≥ x" begins at 0.95 x, as the search for an amplitude stops within 5 % of the wanted strength, where the effect
  can have it: some cannot be so weak, or so strong. Power, names and the confusion matrix (from ENR 0.5) are of one
  effect at a time and by the strength that was reached; power leaves out parameters, which are no detection.
- The noise below a residual is what the diagnosis takes it for: 0.6 to 1.8 times what differences of samples show,
  scaled to what neither the base nor any smooth torque reaches. So a ratio near one says that nothing smooth is left,
  and not that the noise was known.
- Right, too, are `torque_offset` for `direction_asymmetry` and the reverse. `neighbour_coupling`, whose neighbour is
  not logged, is no figure of names: unknown or `external_disturbance` is right for it. Some effects outside the
  catalogue may be called external.
- A proposed motion tells a set apart when, of every set that was printed, something is left and all that is left is
  true.
- Names of parameters are judged like others: false where the simulation has that parameter right, unless the truth is
  in their set. Where inertia and gravity were shifted, `inertia_error` and `payload_error` are right and not counted.
- Pairs are of physics and measurement on a rich motion: no parameters, no pushes, no neighbours. Effects outside the
  catalogue are wanted at ENR 1 or more.
- Intervals of shares are exact and two-sided, for a number of cases that is fixed beforehand. Runs were ended after
  their errors had been read, for which no interval here makes up. Those of medians are order statistics, those of the
  mean size of a set come from drawing cases again; parameters of one case are a cluster.
- Intervals of parameters are compared where the right effect was named and generator and catalogue share the form, or
  the best-fitting value on noise-free data is known; counts, such as an order, have none. Of normal errors behind
  right intervals, 1 of 10,000 would miss by two half widths.
- Pairs are wanted at ENR 0.5 to 8 together; the row tells how strong the weaker one is.
- Time is that on the wall, of two cases side by side on two cores, which had other work for part of the run.

## What is not proved here

- Generator and diagnosis come from one project; effects that neither of them thinks of are not tried, beyond those
  outside the catalogue. Joints whose dynamics and left-out physics are MuJoCo's have [a page of their
  own](second_generator.md); they are not sealed.
- The joints are simulated, one hinge each, recorded at 1 kHz with torque measured on the joint's side, by one
  recording (two where a motion was proposed). Effects injected into real recordings, with real noise, have [a page of
  their own](injected.md).
- The borders of what counts as an effect are not tried: no joint has a delay between 0.25 and 1 ms, a filter of the
  velocity between 2 and 4 ms, or (but for `gms`) a presliding travel between 0.15 and 0.6 mrad.
- An error of the gain, of inertia or of payload is tried with a simulation that is right otherwise: beside another
  error of inertia and gravity nobody can tell it.
- The loop is not told to the diagnosis, which estimates it; load channels hold gravity and inertia, no spring or
  push.
- Motion of a neighbouring joint is not logged, so that `neighbour_coupling` counts as right when it is called unknown
  or external.
- Strength of `presliding_hysteresis` is measured against the stiff bristle of the same joint; a diagnosis that fits
  the bristle's stiffness sees less of it. The torque of `velocity_filter_lag` is that of a simulation driven by the
  late velocity; the recording holds none of it.
- How much of the held-out gap is closed, of what the right structure could close, takes a second diagnosis without
  the concealed torque: `fricomp bench mismatch-gap` measures it on cases of development seeds, and says of which
  diagnosis.
"""
