"""Whether a loop that was given can have moved the joint: it must explain what was commanded."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d

from fricomp.recording import Recording

from .controller import Controller, compute_answer, estimate_controller, read_told_torque
from .settings import INPUT


def check_controller(controller: Controller, recordings: Sequence[Recording]) -> list[str]:
    """List what speaks against a given loop, with its gains and those that the recording shows; empty where nothing
    does."""
    remarks = []
    for i, recording in enumerate(recordings):
        if recording.position_reference is None:
            continue
        explained = _compute_explained(controller, recording)
        if explained >= INPUT.loop_explains:
            continue
        prefix = f"recording {i + 1}: " if len(recordings) > 1 else ""
        units = recording.metadata.torque_unit, recording.metadata.position_unit
        estimated = estimate_controller(recording)
        other = (
            "no PD or PID loop does"
            if estimated is None
            else f"one with {estimated.describe_gains(*units)} explains {estimated.explained:.1%}"
        )
        share = f"only {explained:.0%}" if explained > 0.0 else "nothing"
        remarks.append(
            f"{prefix}Careful: the loop that was given ({controller.describe_gains(*units)}) explains {share} of the "
            f"recorded torque, and {other}: check the file of --controller, or leave it out."
        )
    return remarks


def _compute_explained(controller: Controller, recording: Recording) -> float:
    """Part of the torque's variance that a loop explains; 0 and less where it explains none."""
    torque = read_told_torque(recording)
    rows = max(1, round(INPUT.told_window / recording.sample_period))
    told, left = (uniform_filter1d(one, rows) for one in (torque, torque - compute_answer(controller, recording)))
    return 1.0 - float(np.var(left)) / max(float(np.var(told)), 1e-30)
