"""Which joints have reported: the state is new once every part of it, from every joint, has come again."""

from collections.abc import Callable


class Arrivals:
    """Keeps the joints that are still to report, so that one silent drive among many makes the state stale.

    Args:
        n_parts: Number of joints, times the messages that make up the state of one.

    Attributes:
        mark: To be called with the number of a part that has come.
    """

    def __init__(self, n_parts: int) -> None:
        self._n_parts = n_parts
        self._arrived: set[int] = set()
        self.mark: Callable[[int], None] = self._arrived.add  # without a call of ours around it, for every state

    def take(self) -> bool:
        """Whether all have reported since this was last true; begins anew then."""
        if len(self._arrived) < self._n_parts:
            return False
        self._arrived.clear()
        return True

    def clear(self) -> None:
        """Begin anew."""
        self._arrived.clear()
