"""What [luo2024pinn] prints in tables III, IV, VI and VII: identified values, and the average errors it states."""

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .problem import PaperProblem


class PrintedRow(NamedTuple):
    """One method in the paper.

    Attributes:
        method: Its name.
        values: Identified parameters, forward then reverse. Eight values.
        average: Average error rate that the paper states [%].
    """

    method: str
    values: tuple[float, ...]
    average: float

    def recomputed(self) -> FloatArray:
        """|error| of each parameter from the printed values [%]. Shape (8,)."""
        return PaperProblem().error_percent(np.array(self.values))


NOISE_FREE = (
    PrintedRow("PSO", (0.14992, 0.59125, 0.05050, 0.02013, 0.19977, 0.69804, 0.05011, 0.03039), 0.6359),
    PrintedRow("GA", (0.14976, 0.58847, 0.05068, 0.02032, 0.19994, 0.69868, 0.05007, 0.03008), 0.7075),
    PrintedRow("PINN", (0.15016, 0.60124, 0.04991, 0.01972, 0.20010, 0.70359, 0.04981, 0.02976), 0.4375),
)
"""Tables III to V."""

NOISY = (
    PrintedRow("PSO", (0.15097, 0.60501, 0.04976, 0.01848, 0.19804, 0.68521, 0.05267, 0.03479), 4.2491),
    PrintedRow("GA", (0.15106, 0.60502, 0.05028, 0.02144, 0.19745, 0.69114, 0.05242, 0.03553), 5.0250),
    PrintedRow("PINN", (0.15034, 0.60377, 0.05003, 0.01954, 0.19830, 0.69287, 0.05181, 0.03259), 2.1671),
)
"""Tables VI to VIII."""
