"""A controller of your own in the control loop: python examples/loop.py [friction.json] [drive.toml]

Without a configuration file it moves the simulated joint. With one it moves your drive, at once: 0.4 rad up from where
it is, and back.
"""

import math
import sys

from fricomp import Compensator, FrictionLaw, FrictionModel
from fricomp.adapters import open_adapter
from fricomp.adapters.configuration import read_configuration
from fricomp.control import ControlLoop, ReferenceState
from fricomp.joint import JointFeedback, await_feedback
from fricomp.laws import BidirectionalStribeck, StribeckCurve


class Sway:
    """The motion: `sample` fills in where every joint should be, `time` seconds after the start.

    Args:
        start: Where the joint is [rad]: a reference that begins elsewhere would be reached with all torque there is.
    """

    def __init__(self, start: float) -> None:
        self.start = start

    def sample(self, time: float, state: ReferenceState) -> None:
        state.position[0] = self.start + 0.2 * (1.0 - math.cos(2.0 * time))
        state.velocity[0] = 0.4 * math.sin(2.0 * time)
        state.acceleration[0] = 0.8 * math.cos(2.0 * time)


class StateFeedback:
    """The controller: `torque_into` fills in the torque of every joint, without friction [N·m]."""

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        out[0] = 20.0 * (reference.position[0] - feedback.position[0])
        out[0] += 2.0 * (reference.velocity[0] - feedback.velocity[0]) + 0.1 * reference.acceleration[0]


# The simulated joint's own friction (N·m, N·m, rad/s, N·m·s/rad), where no model is given.
FRICTION = BidirectionalStribeck(StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03))
model = sys.argv[1] if len(sys.argv) > 1 else FrictionModel(FrictionLaw((FRICTION,)))
configuration = read_configuration(sys.argv[2]) if len(sys.argv) > 2 else {"backend": "sim"}

for compensators in (None, [Compensator(model, period=1e-3)]):
    with open_adapter(configuration["backend"], configuration) as adapter:
        adapter.configure("torque", period=1e-3)
        await_feedback(adapter, feedback := JointFeedback(1), 1e-3)
        loop = ControlLoop(adapter, Sway(feedback.position[0]), StateFeedback(), compensators=compensators, period=1e-3)
        result = loop.run(duration=2.0 * math.pi)  # configures, enables, and stops the joint on every way out
    result.raise_if_tripped()
    error = result.log.signal("position_reference") - result.log.signal("position")
    rms = math.sqrt(float((error**2).mean()))
    print(f"{'with' if compensators else 'without'} compensation: tracking error {1e3 * rms:.3f} mrad RMS")
