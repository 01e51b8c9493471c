"""For authors of adapters: the conformance suite, virtual time, and links that fail.

`fricomp.testing.conformance` needs pytest and is imported by tests only.
"""

from fricomp.testing.clock import VirtualClock
from fricomp.testing.faulty_link import FAULTS, FaultyLink
from fricomp.testing.rig import AdapterRig, AdapterUnderTest, GoldenCommand

__all__ = ["FAULTS", "AdapterRig", "AdapterUnderTest", "FaultyLink", "GoldenCommand", "VirtualClock"]
