"""Drive twins: devices that speak real drives' protocols, with simulated joints behind them.

One protocol a module, imported when used, so that a serial twin does not need the CAN packages.
"""

from .axis import DriveAxis, twin_stand_in
from .port import PtyPort
from .twin import DriveTwin, TwinClock, TwinServer

__all__ = [
    "DriveAxis",
    "DriveTwin",
    "PtyPort",
    "TwinClock",
    "TwinServer",
    "twin_stand_in",
]
