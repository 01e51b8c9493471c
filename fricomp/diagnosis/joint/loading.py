"""From recordings to tracks: a uniform grid fine enough to simulate, and the channels that effects may use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import DiagnosisError
from fricomp.recording import Recording

from ..inputs.checks import PART_OF
from ..inputs.controller import Controller
from ..inputs.past import Past
from ..inputs.rigid import Spring
from ..inputs.signal import draw_curve
from ..inputs.spikes import remove_spikes
from ..inputs.track import (
    SIMULATED_SPRING,
    SIMULATED_STIFFNESS,
    FloatArray,
    TorqueNoise,
    Track,
    choose_step,
    differentiate,
    find_calm_samples,
    find_encoder_step,
    measure_position_noise,
    measure_torque_noise,
)
from .settings import JOINT

_CHANNELS = ("load_torque", "temperature", "position_reference", "torque_command", "current")


def has_low_rate(recordings: Sequence[Recording]) -> bool:
    """Whether any recording is too slow for presliding and reversals to be seen in it."""
    return any(recording.sample_period > 3.5e-3 for recording in recordings)


def build_tracks(
    recordings: Sequence[Recording],
    loops: Sequence[Controller | None] = (),
    spring: Spring | None = None,
    acts_late: float = 0.0,
    pasts: Sequence[Past | None] = (),
) -> list[Track]:
    """One track for each recording, all on the same grid.

    Args:
        recordings: Recordings of one joint.
        loops: What moved the joint in each of them; none where that is not known.
        spring: Spring of the simulation. Its torque is taken off: the joint without it is fitted and compared.
        acts_late: Time after its stamp at which the torque acts [s]: it is moved there.
        pasts: How the joint was driven over what each is a stretch of; None, or none at all, where it is all of it.

    Raises:
        DiagnosisError: The recordings mix rotary and linear joints.
    """
    if len({recording.metadata.motion for recording in recordings}) > 1:
        raise DiagnosisError("the recordings mix rotary and linear joints: diagnose one joint at a time")
    dt = choose_step(recordings)
    known, earlier = loops or [None] * len(recordings), pasts or [None] * len(recordings)
    tracks = [
        replace(
            _build_track(_move_torque(recording, acts_late), loop, dt, f"recording {i + 1}"),
            usual_delay=_estimate_usual_delay(recording, acts_late),
            delays=_bound_usual_delay(recording.sample_period, acts_late),
            acts_late=acts_late,
            source=source,
            past=past,
        )
        for i, (recording, loop, past, source) in enumerate(
            zip(recordings, known, earlier, _number_sources(recordings), strict=True)
        )
    ]
    return tracks if spring is None else [_remove_spring(track, spring) for track in tracks]


def _move_torque(recording: Recording, acts_late: float) -> Recording:
    """The recording with its torque where it acts; the first one is held before it comes."""
    if acts_late == 0.0:
        return recording
    time = np.asarray(recording.time)
    return replace(recording, torque=np.interp(time - acts_late, time, recording.torque))


def _number_sources(recordings: Sequence[Recording]) -> list[int]:
    """For each recording or part of one the number of its recording, among those that are used."""
    numbers = [one.metadata.extra.get(PART_OF, i) for i, one in enumerate(recordings)]
    used = list(dict.fromkeys(numbers))
    return [used.index(number) for number in numbers]


def _estimate_usual_delay(recording: Recording, moved: float) -> tuple[float, float]:
    """By how much a torque without any flaw is late behind the `moved` one, and the standard deviation of that [s].

    A command is held for a sample, so that it acts half of one after its instant; a measured torque is the mean about
    it. Which of the two a log holds is often not said, drives differ in when they sample, and a usual filter of a
    torque takes up to half a millisecond. The error of the clock comes on top.
    """
    half = 0.5 * recording.sample_period
    spread = float(np.hypot(0.5 * max(half, JOINT.longest_delay), recording.metadata.clock_error or 0.0))
    return moved - (half if recording.metadata.torque_kind == "commanded" else 0.0), spread


def _bound_usual_delay(period: float, moved: float) -> tuple[float, float]:
    """Earliest and latest that a torque without any flaw comes [s]; one that was moved may belong where it was.

    It may belong to either end of its sample, less what a usual chain is late: for samples of a millisecond to the
    middle, since a whole one would swallow real lags. What a grid finer than the samples is made of plays no part.
    """
    half = 0.5 * period
    return -max(half, period - JOINT.longest_delay), moved + max(half, JOINT.longest_delay)


def _remove_spring(track: Track, spring: Spring) -> Track:
    """The track without the torque that the simulation's spring takes, which is kept as a channel."""
    taken = spring.compute_torque(differentiate(track.position, track.dt, order=0))
    more = {SIMULATED_SPRING: taken, SIMULATED_STIFFNESS: np.full(track.size, spring.stiffness)}
    return replace(track, torque=track.torque - taken, channels={**track.channels, **more})


def _build_track(recording: Recording, loop: Controller | None, dt: float, name: str) -> Track:
    time = np.asarray(recording.time) - recording.time[0]
    grid: FloatArray = np.arange(int(time[-1] / dt + 1e-6) + 1) * np.float64(dt)
    uniform = grid.size == time.size and bool(np.max(np.abs(grid - time)) < 0.02 * dt)

    slow = recording.sample_period > 1.5 * dt

    def sample(values: FloatArray) -> FloatArray:
        if uniform:
            return np.array(values)
        if slow:
            return draw_curve(time, values, grid)
        interpolated: FloatArray = np.interp(grid, time, values)
        return interpolated

    channels = {n: sample(v) for n, v in recording.channels.items() if n in _CHANNELS}
    extra = recording.metadata.extra.get("neighbour_position")
    if isinstance(extra, list):
        channels["neighbour_position"] = sample(np.asarray(extra, dtype=np.float64))
    position, torque, noise, seen_at = np.array(recording.position), np.array(recording.torque), None, None
    if slow:
        velocity = differentiate(position, recording.sample_period)
        seen_at = measure_position_noise(position, velocity)
        seen = measure_torque_noise(torque, find_calm_samples(position, velocity, recording.sample_period))
        torque = remove_spikes(torque, seen.size, position, recording.sample_period)
        noise = TorqueNoise(0.0, seen.size, float(np.exp(-dt / recording.sample_period)))
    track = Track.build(
        dt,
        sample(position),
        sample(torque),
        rotary=recording.metadata.motion == "rotary",
        channels=channels,
        name=name,
        noise=noise,
        position_noise=seen_at,
    )
    resolution = recording.metadata.encoder_resolution or find_encoder_step(position)
    missing = np.zeros(0, dtype=bool) if slow or uniform else _mark_missing(time, grid, dt)
    stamps = time if slow else np.zeros(0)
    return replace(track, resolution=resolution, missing=missing, stamps=stamps, loop=None if slow else loop)


def _mark_missing(time: FloatArray, grid: FloatArray, dt: float) -> NDArray[np.bool_]:
    """The samples of a grid that lie in a step of time from which rows are missing, off both ends. Shape (n,)."""
    after = np.clip(np.searchsorted(time, grid), 1, time.size - 1)
    lost = np.diff(time)[after - 1] > JOINT.missing_step * dt
    off: NDArray[np.bool_] = np.minimum(grid - time[after - 1], time[after] - grid) > 0.5 * dt
    return lost & off
