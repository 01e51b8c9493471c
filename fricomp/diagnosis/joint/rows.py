"""Rows of the residual: the missing torque seen through a short Hann window, every few hundredths of a second."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ..inputs.track import FloatArray, Track


@dataclass(frozen=True)
class RowGrid:
    """Where the rows of one recording lie.

    Attributes:
        window: Weights of the Hann window, which sum to one. Shape (m,).
        centres: Sample index of each row. Shape (n_rows,).
    """

    window: FloatArray
    centres: np.ndarray

    @classmethod
    def build(cls, track: Track, width: float, step: float, settle: float) -> RowGrid:
        """Rows every `step` [s] with windows of `width` [s], leaving out `settle` [s] at both ends."""
        length = max(3, 2 * round(width / track.dt / 2) + 1)
        window = np.hanning(length + 2)[1:-1]
        edge = max(round(settle / track.dt), length)
        stride = max(1, round(step / track.dt))
        return cls(window / window.sum(), np.arange(edge, track.size - edge, stride))

    def average(self, samples: FloatArray) -> FloatArray:
        """Windowed means of `samples` at the rows. Shape (n_rows,)."""
        half = self.window.size // 2
        result: FloatArray = sliding_window_view(samples, self.window.size)[self.centres - half] @ self.window
        return result

    def average_everywhere(self, samples: FloatArray) -> FloatArray:
        """Windowed means of `samples` about each of them, but for half a window at both ends. Shape (n - m + 1,)."""
        return np.convolve(samples, self.window, mode="valid")
