"""A motor held in the hand, behind the electronics of a drive twin: without dynamics, so that only the wire counts."""


class HandHeldAxis:
    """Stands where a twin has its joint: position and velocity are set, torque is looked at.

    Attributes:
        largest_torque: Of all that was ever exerted [N·m].
    """

    def __init__(self) -> None:
        self.position = self.velocity = self.torque = 0.0
        self.temperature = 30.0
        self.torque_limit, self.velocity_limit = 1e3, 1e3
        self.gear_ratio = 1.0
        self.energised = False
        self.loop_gains = (5.0, 0.1)
        self.largest_torque = 0.0
        self._gains, self._most = (0.0, 0.0), 1e3

    def enable(self, mode: str) -> None:
        """Energise."""
        self.energised = True
        self.torque = 0.0

    def disable(self) -> None:
        """Go limp."""
        self.energised, self.torque = False, 0.0

    def command_gains(self, stiffness: float, damping: float) -> None:
        """Gains of the drive's own loop."""
        self._gains = (stiffness, damping)

    def limit_torque(self, most: float) -> None:
        """Bound of the drive's own loop."""
        self._most = most

    def command(self, torque: float, velocity: float = 0.0, position: float = 0.0) -> None:
        """Exert what the drive's loop demands, at once."""
        stiffness, damping = self._gains
        demand = torque + stiffness * (position - self.position) + damping * (velocity - self.velocity)
        self.torque = max(-self._most, min(self._most, demand)) if self.energised else 0.0
        self.largest_torque = max(self.largest_torque, abs(self.torque))
