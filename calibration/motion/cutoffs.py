"""The cutoffs of the filters: low enough that noise of the encoder is no acceleration, and that the joint slides."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.recording import Recording

from .joint_samples import FEWEST_SLIDING, JointSamples, RegressionSettings, sample_joint, split_for
from .noise import measure_position_noise

_DEFAULTS = RegressionSettings()
_NOISE_SHARE = 1e-3
"""Share of the acceleration's power that may be noise: inertia comes out too small by it, less than by chance."""
_MOST_NOISE = 0.15
"""The same share where a lower cutoff leaves too few samples that slide: strokes of a short recording are then seen
better than its inertia, which comes out too small by as much."""
_PERIODS = 20.0
"""Least length of each part between gaps, in periods of the cutoff: its margins take a quarter of it."""
_LEAST_LONG = 0.8
"""Part of the recorded time that must lie in parts of at least that length: one short part between two gaps does not
keep the noise in all the others."""
_LOWER = tuple(2.0 ** (-0.5 * step) for step in range(8))
"""Cutoffs to try, as fractions of the default ones; below the last, 4.4 Hz, few motions keep an acceleration."""
_LOWEST_STEPS = 9
"""Halvings of the power of a cutoff, with which a joint that sticks and slips is looked at; four octaves and a half."""


def choose_settings(recording: Recording, *, gravity: bool = False) -> RegressionSettings:
    """The settings of `choose_samples` alone."""
    return choose_samples(recording, gravity=gravity).settings


class ChosenSamples(NamedTuple):
    """How a recording is filtered, and what comes of it."""

    settings: RegressionSettings
    samples: JointSamples


def choose_samples(recording: Recording, *, gravity: bool = False) -> ChosenSamples:
    """The default settings, with cutoffs low enough that noise of the encoder is no acceleration.

    Noise in a regressor shrinks its coefficient by the noise's share of its power [fuller1987measurement]. Of white
    noise with the density S of a position, the share up to f grows with the fifth power of f:
    (2 pi)^4 S f^5 / 5 of acceleration. Torque and regressors share the low-pass, so a lower one costs samples alone.

    Args:
        recording: What is to be sampled.
        gravity: Whether gravity acts.

    Raises:
        IdentificationError: The recording is too short for the filters.
    """
    density = 2.0 * recording.sample_period * measure_position_noise(recording) ** 2
    best, least = replace(_DEFAULTS, gravity=gravity), np.inf
    sampler = _Sampler(recording)
    noisier: list[RegressionSettings] = []
    for factor in _LOWER:
        settings = _lower(factor, gravity)
        if _share_long(recording, settings) < _LEAST_LONG:
            break
        power = float(np.var(sampler.take(settings).acceleration))
        share = (2.0 * np.pi) ** 4 * density * settings.torque_cutoff**5 / (5.0 * max(power, 1e-300))
        if share < least:
            best, least = settings, share
        if share < _NOISE_SHARE:
            break
        noisier += [settings] if share < _MOST_NOISE else []
    slides = _lower_until_it_slides(sampler, best)
    if sampler.count_sliding(slides) < FEWEST_SLIDING:
        wider = (one for one in reversed(noisier) if sampler.count_sliding(one) >= FEWEST_SLIDING)
        slides = next(wider, slides)
    return ChosenSamples(slides, sampler.take(slides))


class _Sampler:
    """Samples of a recording; those of the last settings are kept, since they are asked for again."""

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self._last: ChosenSamples | None = None

    def take(self, settings: RegressionSettings) -> JointSamples:
        """The samples by these settings."""
        if self._last is None or self._last.settings != settings:
            self._last = None  # two of them would be in memory at once
            self._last = ChosenSamples(settings, sample_joint(self.recording, settings))
        return self._last.samples

    def count_sliding(self, settings: RegressionSettings) -> int:
        """How many of them slide."""
        return int(np.count_nonzero(self.take(settings).sliding(settings.slowest)))


def _lower(factor: float, gravity: bool) -> RegressionSettings:
    return RegressionSettings(
        position_cutoff=_DEFAULTS.position_cutoff * factor,
        torque_cutoff=_DEFAULTS.torque_cutoff * factor,
        gravity=gravity,
        margin=_DEFAULTS.margin / factor,
    )


def _share_long(recording: Recording, settings: RegressionSettings) -> float:
    """Part of the recorded time in parts between gaps that are long enough for these cutoffs."""
    parts = split_for(recording, settings)
    durations = [part.duration for part in parts.parts]
    every = sum(durations) + sum(parts.short)
    return sum(one for one in durations if one >= _PERIODS / settings.torque_cutoff) / max(every, 1e-300)


def _measure_durations(recording: Recording, settings: RegressionSettings) -> list[float]:
    """Of the parts between gaps [s]."""
    return [part.duration for part in split_for(recording, settings).parts] or [0.0]


def _lower_until_it_slides(sampler: _Sampler, settings: RegressionSettings) -> RegressionSettings:
    """`settings`, or lower cutoffs through which the joint slides: one that sticks and slips does so on the mean only.

    The friction that comes out is then the mean of sticking and slipping at that speed.
    """
    if sampler.count_sliding(settings) >= FEWEST_SLIDING:
        return settings
    factor = settings.torque_cutoff / _DEFAULTS.torque_cutoff
    for step in range(1, _LOWEST_STEPS):
        lower = _lower(factor * 2.0 ** (-0.5 * step), settings.gravity)
        if max(_measure_durations(sampler.recording, lower)) < _PERIODS / lower.torque_cutoff:
            break
        if sampler.count_sliding(lower) >= FEWEST_SLIDING:
            return lower
    return settings
