"""A base whose inertia and gravity are those of the simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..effects import Context
from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray
from ..joint.solver import Box
from .settings import SEARCH

N_BODY = 3
"""Parameters of the base that a simulation says: log inertia and gravity, which come first."""


def move_to(body: FloatArray, theta: FloatArray, contexts: Sequence[Context]) -> FloatArray:
    """The base `theta` with the log inertia and gravity of `body`, shape (3,), and the same mean torque. Shape (p,).

    Over a short range gravity is nearly constant, and what it was taken to be too large stands in the offset. A fit
    that starts there finds its way back by bending the friction instead.
    """
    position = np.concatenate([context.position for context in contexts])
    less = theta[1:N_BODY] - body[1:N_BODY]
    result: FloatArray = np.concatenate([body, theta[N_BODY:]])
    result[3] += float(np.mean(less[0] * np.cos(position) + less[1] * np.sin(position)))
    return result


def hold(box: Box, rigid: RigidJoint) -> Box:
    """`box` with a narrow prior on inertia and gravity.

    About a vertical axis there is no gravity, and one held to exactly nothing would drown all else that is fitted.
    """
    gravity = SEARCH.body_held * max(float(np.hypot(*rigid.gravity)), SEARCH.body_least_gravity * float(box.scale[1]))
    centre: FloatArray = np.concatenate([[np.log(rigid.inertia), *rigid.gravity], box.centre[N_BODY:]])
    precision = box.precision.copy()
    precision[range(N_BODY), range(N_BODY)] = np.array([SEARCH.body_held, gravity, gravity]) ** -2.0
    return replace(box, centre=centre, precision=precision)
