"""What nobody would notice, however sure it is."""

from __future__ import annotations

LEAST_MATTER = 0.005
"""Part of the friction of its joint that a named term is at least, of a joint's torque that a link which is off changes
at least, and of a joint's friction or way by which files are worse than the simulation before it is told. Without noise
anything is sure, as what the integrator of a simulator does; and two right answers differ by chance."""
