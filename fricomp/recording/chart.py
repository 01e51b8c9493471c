"""The picture of a recording: channels over time."""

from collections.abc import Mapping

from fricomp.recording.validity import Samples
from fricomp.report import Chart, Line, Panel


def channel_chart(time: Samples, channels: Mapping[str, Samples], units: Mapping[str, str], joint: str) -> Chart:
    """One panel a channel, one below the other.

    Args:
        time: [s]. Shape (n,).
        channels: Values by name.
        units: Unit of each channel.
        joint: Name of the joint, for the title.
    """
    panels = tuple(
        Panel((Line(time, values, color=number, width=1.0),), "time [s]", f"{name.replace('_', ' ')} [{units[name]}]")
        for number, (name, values) in enumerate(channels.items())
    )
    return Chart("recording", f"Recording of joint {joint}", panels, panel_height=180, share_x=True)
