"""What an arm carries at its end, from joint torques: more in one session than in another, or than its simulation.

    tau_j = sum over bodies Y_jb(q, v, a) w_b + [session] Y_je(q, v, a) w_p + friction_j(v, tau_j)

The weights w_b of the bodies are whatever the recordings say, for each joint on its own; only w_p is shared by all
joints. So the simulation need not know what its links weigh, and no motion has to be repeated [hollerbach2016]. Of one
session alone the bodies weigh what the simulation says, and w_p is what they leave.
"""

from .answer import diagnose_payload, group_sessions
from .estimate import Payload, find_payload

__all__ = ["Payload", "diagnose_payload", "find_payload", "group_sessions"]
