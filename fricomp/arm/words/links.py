"""What is off of links, in words; from the record alone."""

from __future__ import annotations

import math

from ..record import LinkRecord, LoneLink
from .quantity import show_quantity


def name_link(link: LinkRecord) -> str:
    """With how much heavier it is, where its mass is what is off, or how far off its centre would be at that mass."""
    low, high = (end - link.simulated_mass for end in link.mass.ci95)
    if low <= 0.0 <= high:
        moved = [
            one.value - link.simulated_first_moment[axis]
            for axis, one in link.first_moment.items()
            if axis in link.determined
        ]
        way = float(f"{1e3 * math.hypot(*moved) / max(link.simulated_mass, 1e-9):.2g}")  # 120, and not 1.2e+02
        return f"{link.name} (mass elsewhere, as if its centre were off by {way:g} mm{_say_instead(link)})"
    return f"{link.name} ({link.mass.value - link.simulated_mass:+.3g} kg{_say_instead(link)})"


def _say_instead(link: LinkRecord) -> str:
    """Which other links would do in place of one that is off, if any would."""
    return f"; or {' or '.join(link.instead)} is off in its place" if link.instead else ""


def say_lone_link(found: LoneLink | None) -> tuple[str, ...]:
    """Which link alone is heavier or lighter, if one is, and what else would do."""
    if found is None:
        return ()
    alike = f", and so would {' or '.join(found.alike)} by another factor" if found.alike else ""
    return (
        f"One link explains what the torques ask for, the others being as simulated: {found.name}, if all of it weighs "
        f"{show_quantity(found.factor)} times what the simulation has{alike}.",
    )


def say_link(link: LinkRecord) -> str:
    """What is off of a link."""
    gap = link.mass.value - link.simulated_mass
    low, high = (end - link.simulated_mass for end in link.mass.ci95)
    if low <= 0.0 <= high:
        shown = {axis: one for axis, one in link.first_moment.items() if axis in link.determined}
        moved = ", ".join(
            f"{axis} {show_quantity(one)} for {link.simulated_first_moment[axis]:.3g} there"
            for axis, one in (shown or link.first_moment).items()
        )
        where = f"{link.name} has its mass elsewhere than in the simulation: first moments {moved}"
        where += _say_instead(link)
        return f"{where}." if "mass" in link.determined else f"{where}; how heavy it is, this motion does not show."
    way = "heavier" if gap > 0.0 else "lighter"
    low, high = sorted((abs(low), abs(high)))
    size = f"{abs(gap):.3g} kg {way} than in the simulation (95 %: {low:.3g} to {high:.3g} kg)"
    return f"{link.name} is {size}{_say_instead(link)}."
