"""What `fricomp.identify` gives: friction, the rigid body beside it, the network that departs, and what to know."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from fricomp.calibration.identification import (
    DiscrepancyNetwork,
    IdentificationResult,
    Status,
    save_discrepancy,
    save_identification,
)
from fricomp.calibration.motion.identify import MotionIdentification
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.model import FrictionModel
from fricomp.overview import Overview, Shown
from fricomp.recording.parts.parts import UsableParts
from fricomp.result_kinds import IDENTIFICATION
from fricomp.results import claim_folder

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Identification(Shown):
    """Friction identified from a table or a recording.

    Attributes:
        result: Parameters, intervals, status and network of the friction.
        motion: Inertia, gravity and offset that were fitted with it; None for a table, which is friction alone.
        network: The network that may leave the law; None where it was not asked for.
        notes: What to know about the answer, in sentences.
        facts: How it was made, for the report.
        data: What was used of the recording and what was not; None for a table.
    """

    result: IdentificationResult
    motion: MotionIdentification | None
    network: DiscrepancyNetwork | None
    notes: tuple[str, ...]
    facts: Mapping[str, str]
    data: UsableParts | None = None

    @property
    def model(self) -> FrictionModel:
        """The friction model, to be given to a `Compensator` or to `fricomp.save_model`."""
        return self.result.model

    @property
    def parameters(self) -> dict[str, float]:
        """Estimated parameters by dotted name, in their own units."""
        return self.result.parameters

    @property
    def status(self) -> Status:
        """How it ended; `result.message` says it in a sentence."""
        return self.result.status

    @property
    def is_usable(self) -> bool:
        """Whether a compensator and the exports take the model, or a network departs, which is then what was asked."""
        departs = self.network is not None and self.network.departs
        return departs or find_doubt_in_status(self.result.status, "") is None

    def headline(self) -> str:
        """That of the friction."""
        return self.result.headline()

    def overview(self) -> Overview:
        """Parameters with their 95 % intervals, and what to know about them."""
        found = self.result.overview()
        return replace(found, sentences=(*found.sentences, *self.notes))

    def plot(self) -> Figure:
        """Draw the points and the identified curve with its 95 % band, with matplotlib.

        Raises:
            MissingExtraError: matplotlib is not installed.
        """
        return self.result.plot()

    def save(self, folder: str | os.PathLike[str], *, overwrite: bool = False) -> tuple[Path, ...]:
        """Write model, network and report as the command does.

        Args:
            folder: Where to; it is made if it is not there.
            overwrite: Whether an earlier identification there may be replaced.

        Raises:
            OutputError: Something would be replaced that is not to be, or another process writes there.
            MissingExtraError: onnx, plotly, jinja2 or matplotlib is not installed.
        """
        with claim_folder(Path(folder), IDENTIFICATION, overwrite=overwrite) as claim:
            claim.clear()
            return write_identification(self, Path(folder))


def write_identification(found: Identification, folder: Path) -> tuple[Path, ...]:
    """Write report, model and networks into a folder that is kept to this process.

    Returns:
        Model, network, report and, where one departs, the network that does.
    """
    from fricomp.calibration.identification.report.page import write_identification_report

    report = write_identification_report(found.result, folder, found.notes, dict(found.facts), found.data)
    files = save_identification(found.result, folder)
    written = (files.model, files.network, report)
    if found.network is None or not found.network.departs:
        return written
    return (*written, save_discrepancy(found.network, found.result, folder, files.model_sha256))
