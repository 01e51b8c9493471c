"""How `fricomp.identify` identifies friction."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from fricomp.calibration.identification.identify import Loss, Method


@dataclass(frozen=True)
class IdentifySettings:
    """How friction is identified; see `identify` for what each means."""

    method: Method = "pinn"
    noise: str | ArrayLike = "auto"
    loss: Loss = "gaussian"
    law: str = ""
    gravity: bool | None = None
    seed: int = 0
    depart: bool = False

    def to_facts(self, name: str) -> dict[str, str]:
        """What a report says of these settings, and of the data called `name`."""
        return {"file": name, "seed": str(self.seed), "loss": self.loss}
