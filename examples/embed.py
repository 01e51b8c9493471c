"""The compensator in a loop of your own: python examples/embed.py [friction.json]"""

import sys

from fricomp import Compensator, FrictionLaw, FrictionModel
from fricomp.laws import BidirectionalStribeck, StribeckCurve

FRICTION = BidirectionalStribeck(StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03))
model = sys.argv[1] if len(sys.argv) > 1 else FrictionModel(FrictionLaw((FRICTION,)))

compensator = Compensator(model, period=1e-3)
print(compensator.describe())
for velocity_reference, velocity in ((0.0, 0.0), (0.02, 0.0), (0.02, 0.019), (0.2, 0.2), (-0.2, -0.2)):
    your_controller = 0.0  # whatever your loop commands without friction
    torque = your_controller + compensator.torque(velocity_reference, velocity)
    print(f"reference {velocity_reference:+.3f}, measured {velocity:+.3f} rad/s: {torque:+.4f} N·m")
