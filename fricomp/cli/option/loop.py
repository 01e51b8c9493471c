"""Options of a position loop that `run` and `check-loop` share."""

from typing import Annotated

from fricomp.cli.option.panel import option_under

DELAY, VELOCITY_FILTER = 0.002, 0.005
"""Of a loop that nobody has measured: those of the simulated joint at 1 kHz [s]."""

loop_option = option_under("Loop")

Delay = Annotated[float, loop_option(help="Delay from motion to the torque that answers it [s].")]
"""The option; its default is `DELAY`."""
VelocityFilter = Annotated[float, loop_option(help="Time constant of the measured velocity's filter [s].")]
"""The option; its default is `VELOCITY_FILTER`."""
Gain = Annotated[float | None, loop_option(help="Gain of the compensation; chosen from the model if left out.")]
"""The option; its default is None."""
