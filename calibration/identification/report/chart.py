"""Charts and words that the reports of a calibration and of an identification share."""

import numpy as np

from fricomp.report import PALETTE, Chart, Line, Panel

from ..curve import REACH
from ..estimation.pinn import Traces
from ..result import IdentificationResult

__all__ = ["REACH", "network_note", "training_chart", "words"]

_NAMES = {
    "coulomb_torque": "Coulomb torque",
    "static_torque": "static torque",
    "stribeck_velocity": "Stribeck velocity",
    "viscous_coefficient": "viscous coefficient",
}


_BEGINNINGS = {
    "given": "from the start that was given",
    "projection": "from a start by variable projection",
    "least_squares": "from the optimum of least squares, because from its other starts training ended elsewhere",
}


def words(name: str) -> str:
    """A parameter's name in words: `stribeck.forward.coulomb_torque` is `Coulomb torque, forward`."""
    *group, last = name.split(".")
    side = f", {group[-1]}" if group and group[-1] in ("forward", "reverse") else ""
    return _NAMES.get(last, last.replace("_", " ")) + side


def training_chart(traces: Traces, unit: str) -> Chart:
    """Parameters and losses over the iterations.

    Args:
        traces: Of the training.
        unit: Of torque.
    """
    steps = np.arange(1.0, len(traces.data_loss) + 1.0)
    final = np.abs(traces.parameters[-1])
    lines = tuple(
        Line(steps, traces.parameters[:, i] / final[i], words(name), color=i % len(PALETTE))
        for i, name in enumerate(traces.names)
    )
    losses = (Line(steps, traces.data_loss, "data"), Line(steps, traces.model_loss, "closed form"))
    panels = (
        Panel(lines, "iteration", "parameter / final value [1]", "Parameters"),
        Panel(losses, "iteration", f"mean squared error [({unit})²]", "Losses", y_scale="log"),
    )
    caption = f"Network and parameters are trained together, {_BEGINNINGS[traces.start]}."
    return Chart("training", "Training of network and parameters", panels, caption=caption, panel_height=260)


def network_note(result: IdentificationResult) -> str:
    """What the exported network is worth, and that the trained one is another."""
    exported = (
        f"The exported network was trained to the closed form by collocation, and differs from it by at most "
        f"{result.distillation.largest_error:.1e} of the largest torque on a grid between the training points."
    )
    network = result.identifying_network
    if network is None:
        return exported
    velocity = np.linspace(-1.0, 1.0, 2001) * float(result.observations.speed.max())
    velocity = velocity[np.abs(velocity) >= result.observations.speed.min()]
    apart = np.max(np.abs(np.asarray(network.torque(velocity)) - np.asarray(result.network.torque(velocity))))
    return (
        "The network that was trained together with the parameters follows the noise of the points. Between them it is "
        f"up to {float(apart):.3g} {result.model.torque_unit} from the exported one, and is not the one to use. "
        f"{exported}"
    )
