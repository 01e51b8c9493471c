"""The page `docs/identification.md`: measured figures from the ledger between what they mean."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib.metadata import version

from fricomp.report import Chart

from ..kit.store import RowStore
from .printed import NOISE_FREE, NOISY
from .problem import NOISE_READINGS
from .rivals import FULL_SIZES
from .sections import (
    departure_section,
    extras_section,
    load_section,
    noise_free_section,
    outlier_section,
    printed_table,
    search_section,
    statistics_section,
    target_table,
    timing_section,
)

__all__ = ["CLOSING", "identification_page"]

_INTRODUCTION = """# Identification

Written by `fricomp bench paper`; every number in a table is measured by it. The comparison is with [luo2024pinn]
(see [references](references.md)), whose data, bounds and settings it repeats.

## The method, and what it is not

Eight parameters of the bidirectional Stribeck law and the paper's 2-20-20-20-1 tanh network are trained together on
the paper's two losses, each residual divided by its noise. Turning each pair of residuals (data, model) by 45 degrees
leaves the sum of squares as it is and separates it: one part holds the friction parameters alone and is the
likelihood, the other is what the network still has to learn. A Levenberg-Marquardt step in float64 eliminates the
network's weights through a system with one row a point, and training ends when the likelihood's own gradient says that
the parameters are within 0.005 standard deviations of its optimum. All parameters are estimated as logarithms, and so
are positive.

**Where training starts.** At a fixed Stribeck velocity the law is linear in its other parameters. A scan of that
velocity over the speeds measured gives the start (variable projection), so that no range is asked for. It is close
already: on draws with 5 % noise some 0.4 to 3 standard deviations from the optimum. How training fares from elsewhere
is what the random starts without noise show. Of a start that is given (`IdentificationOptions(start=...)`) the Stribeck
velocities are taken, brought within the speeds measured, and the other parameters solved for.

The optimum of least squares is worked out beside it, as a check. Where training from none of these starts ends within
0.05 standard deviations of that optimum, it begins anew there, and then only keeps what least squares found. This
happens on data that leave parameters open; `result.traces.start` and the caption of the report's chart say so.

**The PINN gains nothing over least squares on data that follow the law.** With equal weights and a network that can
represent the curve, the paper's loss has the optimum of weighted least squares; the distances measured below are what
is left of the difference. `identify(..., method="least_squares")` gives the same parameters faster. One data set
proves nothing either: the mean error of a single draw varies severalfold around that of the Cramér-Rao bound (below).

With relative noise, maximum likelihood includes how the noise grows with the model's torque (the determinant). It is
solved as least squares by a rescaling with the geometric mean of the model, exactly. Reweighted least squares without
the determinant ends elsewhere, by a few hundredths of a standard deviation.

The network that identified follows the noise of its points. The one exported is trained anew on a grid, to the closed
form; where held-out points ask for it, `fit_discrepancy` (`fricomp identify --depart`) lets it leave the closed form.

## Wanted and measured
"""

_PRINTED = (
    "`average recomputed` averages the errors of the values above it. Two printed averages do not follow from the "
    "printed values: 0.4375 of the PINN without noise, and 5.0250 of GA with noise. The paper does not say which "
    "reading of 5 % noise it used; ours are draw 0 of both.\n"
)

_CONVERGENCE = (
    "On data without noise every method has the same exact optimum, so an error that is left says only that a method "
    "has not converged, and an average of such errors compares stopping times. That holds for the paper's PINN as for "
    "its PSO and GA: compare the errors printed above with those of the same searches run again here for the paper's "
    "50,000 iterations. The paper does not say where its training by Adam starts. What it reaches depends on that, "
    "and it is repeated here from random starts, by the rule that ours starts by.\n"
)

_SEARCHES = (
    "All minimise the same negative log-likelihood (NLL) of the same draws, except Adam, which minimises the paper's "
    "unweighted loss, and robust NLS, scipy's soft L1 loss from one random start. PSO and GA: population 100, the "
    "paper's bounds, learning factors 1, compiled (`compiled_search.py`); (pymoo) are the same rules as pymoo runs "
    "them. Length: iterations, evaluations for CMA-ES, steps for Adam. Ours is the PINN. "
    f"A whole run has {FULL_SIZES.full} draws at the paper's length and {FULL_SIZES.tenth} at a tenth; where a row "
    "has fewer, the run was ended before, for these searches take most of its time.\n"
)

_TIMES = (
    "Processor time of one thread, all methods one after another in one process; ours is the median of 20 draws (20 "
    "random starts without noise), that of the searches of 5 draws. PSO, GA and Adam are timed over a tenth of their "
    "length and multiplied. Without noise, on 41 points, ours has to iterate longest and a compiled search has least "
    "to evaluate. The paper's length is more than a search needs: `until at the optimum` counts, in runs of a tenth of "
    "it, until the best is within 0.01 nats of the optimum (without noise: has a mean error of 1e-3 %), and is empty "
    "where most runs do not get there. A search does not know when it is there, nor whether: see the draws above that "
    "end elsewhere.\n"
)

_OUTLIERS = (
    'One point in ten is off by ten standard deviations, either way, `loss="robust"`; the PINN weighs the points as '
    "the robust fit beside it does. Where two of the three slowest points of a direction are hit, two basins can "
    "explain the data about equally well, and no method without further knowledge tells them apart; such draws are "
    "reported as `wrong_basin_suspected`. The intervals take it as known which points are off, and are somewhat too "
    "narrow. RMS and coverage are given for the eight parameters in the order of the tables above.\n"
)

_DEPARTURE = (
    "RMS torque error against the truth [N·m]; noise 0.01 N·m. `departs` has a hump of 0.15 N·m at 0.45 rad/s and a "
    "cubic term on top of the paper's law. The exported network may leave the closed form as far as cross-validation "
    "asks for it: each fold begins from the closed form of the points it was left, and visits to one speed are left "
    "out together. The data-driven one is held by the data alone, the paper's third comparison; it too begins as the "
    "closed form, which is better than the random weights of a network that knows no law. Beyond the speeds means "
    "1 to 1.4 times the fastest one measured. No network predicts better than the closed form where the joint follows "
    "the law; where it does not, one does between the points, if there are enough of them to show it; beyond the "
    "speeds measured, little is gained by any. With few points the choice keeps to the closed form more often than "
    "would be best where the joint departs; trusting the data alone is what fails where it does not.\n"
)

_LOADS = (
    "\nAt five normal loads from 5 to 20, dry friction proportional to the load, `departs` with a hump that grows with "
    "it. Between the loads means four others in between, beyond them 1.2 times the largest. Each load between others "
    "is left out in turn before a network is trusted. A network over the load has no shape to hold it where it was "
    "not measured: extrapolate loads with the closed form.\n"
)

CLOSING = """
## Other laws, uncertainty, design

**Where the joint does not follow the law** within the scatter of its points, the status is `lack_of_fit`, told ahead of
`converged` and `wrong_basin_suspected`: what is left is compared, by an F-test at 0.1 %, with cosines over the
logarithm of speed in each direction. The model stays usable at the speeds measured; its intervals do not, for they
hold, like every coverage on this page, for a joint that follows the law, with the Stribeck exponent 2. An exponent of 1
(40 speeds a direction, noise 0.01 N·m) moves the static torque by a sixth and is told in 60 of 60 data sets, in 53 of
60 with 20 speeds, and in 1 of 60 with 8: few points do not show it. Of joints that follow the law one in a thousand is
doubted. It is not looked for in samples of one motion or in half differences of a sweep, whose errors are shared. The
report shows F_c, F_s and v_s by profile likelihood too. With `loss="robust"` deviations allow for outliers that are
only guessed: of the 95 % intervals of converged draws with a tenth of outliers, 95.5 % (relative noise) and 93.5 %
(absolute) hold the truth, in 100 draws each. (`pytest tests/calibration/identification/test_adequacy.py`)

**What the data do not determine** is `not_identifiable`, told before anything on convergence, with the speeds to add.
So is a Stribeck velocity whose 95 % profile is open towards zero or infinity, whatever the standard deviation says; and
a direction in which no Stribeck effect shows (by a search over its velocity, at 1 % a direction), with the advice to
take a law without one. Friction whose sign would drive the joint in one direction at a quarter of the speeds is an
offset or gravity in the table, and is called so; a smaller offset passes for a difference between the directions, and
the command notes how large it would be. A parameter that no point depends on, or that only acts together with another,
has an infinite standard deviation; in model files it is a million times the value, because JSON has no infinity, and
`compare` and the gain give it no weight. Coulomb and static torque are at most ten times the largest torque measured.
The model file keeps the status, its sentence, the largest friction of the data and the slowest speeds; `Compensator`
and the exports refuse a model whose status is not `converged`, `lack_of_fit` or `wrong_basin_suspected` unless
`any_status=True`. A viscous coefficient near zero counts as known where it is worth less than 5 % of the largest torque
at the fastest speed, and a sensitivity to the load near zero where what it changes over the loads is.

**A recorded motion** cannot tell a constant torque offset from friction that differs between the directions. The
bidirectional law takes the whole of it and the message says how large the offset would be with the same friction in
both; only where friction would have to drive the joint in one direction does the offset stay. Only
samples through whose low-pass the joint slides in one direction count, for the rigid body too: at rest friction is
whatever holds the joint, such as minus gravity. Where friction builds up over a way after rests and reversals, that way
is left out and named; a static law still gives too low a static torque where that way is long. Rigid body and friction
are fitted together, and standard deviations allow for both and for correlated errors [newey1987]. A torque signal that
is late by 3 ms would put half the viscous coefficient on top of it, or more: the lag, or lead, is estimated from what
of the torque's slope neither rigid body nor friction can imitate, is said and taken off, up to 50 ms (more where the
low-pass is lower), with a warning above 10 ms and no convergence beyond. Where the motion does not tell it, it is
0 ± 4 ms, and that is in the standard deviations. Friction that builds up after reversals may pass for some tenths of a
millisecond of it. The low-pass is
lowered where the encoder's noise would pass for acceleration. What stays unknown is `not_identifiable`; a recording in
which fewer than 200 filtered samples slide is refused.

**Its intervals.** The static torque shows in the few slowest samples of each stroke, which are off together: by the
encoder, whose speed is uncertain where the curve is steepest, and by the low-pass, which rings of a reversal whose time
is known to a sample. No variance is therefore below that of leaving out each block of a stroke in turn
[kunsch1989bootstrap], [mackinnon2023leverage], and the likelihood is flattened by as much as that widens an interval
over independent samples. F_c, F_s and v_s bend the curve, so their likelihood is not quadratic: where its profile is
far from the covariance, the command prints the profile's ends, and where it is open the status is `not_identifiable`.
`fricomp bench motion --seeds 30` (joints drawn at random, 20 s at 500 Hz of three swings, an encoder of 18 bits, torque
noise of 0.5 to 2 % of the static torque): 24 of 30 are usable, and 178 of their 192 intervals hold the truth (93 %), 88
of 96 of those of static torque and Stribeck velocity; by the covariance alone it is 176 and 86, one static torque being
off by 13 of its deviations.

`identify(..., law=...)` takes `coulomb`, `coulomb_viscous`, `tanh`, `arctan`, `symmetric_stribeck`, `stribeck` from
points, and `dahl`, `lugre` from a time series with reversals (output error; a network of velocity and load has no
state and takes no part). Their velocity must be smooth: what differences of an encoder's counts jump by passes for
speed, and is in no interval. `choose_law` compares by held-out likelihood. `profile_interval` serves where the
likelihood is not quadratic, `block_bootstrap` where points are correlated. With
`normal_load` the parameters hold at the mean load of the points, and this is the load that is assumed wherever none is
known later; `fricomp compare` brings models that know their loads to one load first.
"""


def identification_page(ledger: RowStore, charts: Sequence[Chart], command: str, folder: str) -> str:
    """The whole page as Markdown.

    Args:
        ledger: Finished draws.
        charts: Drawn into `folder` under their names.
        command: What wrote the page.
        folder: Where its pictures lie, seen from the page.
    """

    def pictures(*beginnings: str) -> str:
        found = [chart for chart in charts if chart.name.startswith(beginnings)]
        return "\n".join(f"![{chart.title}]({folder}/{chart.name}.png)\n" for chart in found)

    parts = [
        _INTRODUCTION,
        target_table(ledger),
        _how(command),
        "## Without noise: tables III to V, figures 2 to 7\n",
        printed_table(NOISE_FREE, ledger, ["none"]),
        _CONVERGENCE,
        noise_free_section(ledger),
        pictures("data", "convergence", "pinn-none", "pso-none", "ga-none", "adam-none"),
        "## With 5 % noise: tables VI to VIII, figures 8 to 12\n",
        printed_table(NOISY, ledger, NOISE_READINGS),
        _PRINTED,
        *(pictures(f"pinn-{r}", f"pso-{r}", f"ga-{r}", f"adam-{r}") for r in NOISE_READINGS),
        "## Over many draws\n",
        *(statistics_section(ledger, reading) for reading in NOISE_READINGS),
        pictures("errors"),
        "## Beside PSO, GA, CMA-ES, robust NLS and the paper's Adam\n",
        _SEARCHES,
        search_section(ledger),
        _TIMES,
        timing_section(ledger),
        "## Outliers\n",
        _OUTLIERS,
        outlier_section(ledger),
        "## Where the joint is no Stribeck joint\n",
        _DEPARTURE,
        departure_section(ledger),
        *((_LOADS, loads) if (loads := load_section(ledger)) else ()),
        "\n## Sweep chosen for information, and LuGre\n",
        extras_section(ledger),
        CLOSING,
    ]
    return "\n".join(part for part in parts if part)


def _how(command: str) -> str:
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "torch"))
    return (
        f"Command: `{command}`; the figures are in `figures.json` beside the pictures. Draw k of a reading has the "
        f"seed k. Machine: {os.cpu_count()} cores, {platform.machine()}, Python {platform.python_version()}, "
        f"{packages}.\n"
    )
