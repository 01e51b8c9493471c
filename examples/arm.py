"""Friction under the load of a whole arm, in a loop of your own: python examples/arm.py [runs/arm]

The folder is one that `fricomp diagnose LOG --simulation arm.urdf --out runs/arm` has written.
"""

import sys
import tempfile
from pathlib import Path

from fricomp import Compensator, FrictionLaw, FrictionModel
from fricomp.control import ArmCompensator, ArmLoad, JointLimits, SafetyGate
from fricomp.joint import JointFeedback
from fricomp.laws import BidirectionalStribeck, LoadCoulomb, StribeckCurve
from fricomp.model import Validity

TWO_LINKS = """<mujoco><worldbody>
<body><inertial pos="0 0 0.15" mass="4" diaginertia="0.04 0.04 0.01"/><joint name="shoulder" axis="0 1 0"/>
<body pos="0 0 0.35"><inertial pos="0 0 0.12" mass="2.5" diaginertia="0.02 0.02 0.005"/>
<joint name="elbow" axis="0 1 0"/></body></body></worldbody></mujoco>"""


def build_arm() -> ArmCompensator:
    """Two joints whose friction grows by a tenth of what they carry."""
    curve = StribeckCurve(1.0, 1.4, 0.05, 0.6)
    law = FrictionLaw((BidirectionalStribeck(curve, curve), LoadCoulomb(0.1)))
    model = FrictionModel(law, validity=Validity(velocity=(-2.0, 2.0), load_torque=(-40.0, 40.0)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.xml"
        path.write_text(TWO_LINKS)
        return ArmCompensator([Compensator(model), Compensator(model)], ArmLoad(path))


arm = ArmCompensator.read(sys.argv[1]) if len(sys.argv) > 1 else build_arm()
n, now = len(arm.joints), 1_000_000_000
gate = SafetyGate([JointLimits(torque=80.0, torque_rate=2e4, velocity=3.0)] * n, period=1e-3, ramp_time=0.0)
feedback, friction, command = JointFeedback(n), [0.0] * n, [0.0] * n
gate.arm(now)
for speed in (0.0, 0.1, 0.5, -0.5):
    now += 1_000_000
    feedback.time_ns, feedback.position[:], feedback.velocity[:] = now, [0.4] * n, [speed] * n  # from your drives
    gate.observe(feedback, now)
    arm.torque_into(friction, [speed] * n, feedback.velocity, None, None, feedback.position, [0.0] * n)
    # beside what your controller asks for:
    wanted = [one + rest for one, rest in zip(friction, arm.feed_forward, strict=True)]
    gate.admit(wanted, command, now)
    print(f"{speed:+.1f} rad/s: load {arm.load[0]:+.2f}, friction {friction[0]:+.2f}, sent {command[0]:+.2f} N·m")
