"""What a load draws through a flexible or loose transmission, compared with a rigid one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .kernel import drive_load
from .track import FloatArray

if TYPE_CHECKING:
    from .effects import Context

__all__ = ["carried"]

_DAMPING_RATIO = 0.1  # of the load on its spring; typical of harmonic drives


def carried(context: Context, stiffness: float, load_share: float, gap: float) -> FloatArray:
    """Torque on the motor side beyond that of a rigid transmission [N·m]. Shape (n,).

    Args:
        context: Motion of the motor side.
        stiffness: K [N·m/rad].
        load_share: Part of the joint's inertia that sits behind the transmission.
        gap: Total free travel [rad].
    """
    plant = context.plant
    inertia = plant.inertia * load_share
    gravity = plant.gravity_torque(context.position, context.rotary) - plant.offset
    damping = 2.0 * _DAMPING_RATIO * np.sqrt(stiffness * inertia)
    substeps = int(np.clip(np.ceil(np.sqrt(stiffness / inertia) * context.dt / 0.3), 1, 20))
    settings = np.array([context.dt, substeps, inertia, stiffness, damping, 0.5 * gap])
    torque: FloatArray = drive_load(context.position, context.velocity, gravity, settings)
    return torque - (inertia * context.acceleration + gravity)
