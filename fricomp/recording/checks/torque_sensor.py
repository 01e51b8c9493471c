"""A torque sensor beside the motor's torque: the gain of the latter, and how far it saturates."""

from fricomp.recording.checks.torque_causes import fit_two_torques
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording


def find_torque_gain(recording: Recording) -> tuple[Finding, ...]:
    """A motor torque that is not what the sensor measures, beside the inertia and the friction between both."""
    fit = fit_two_torques(recording)
    if fit is None:
        return ()
    if not fit.is_off and not fit.saturates:
        return ()
    said = f"load_torque is {fit.gain:.3g} ± {fit.gain_deviation:.1g} times torque"
    if fit.saturates:
        said = (
            f"load_torque is {fit.small_gain:.3g} times torque at small torques and {100 * fit.loss:.0f} % less of it "
            f"at {fit.largest:.3g} {recording.metadata.torque_unit}: the motor saturates"
        )
    message = f"{said}, {100 * fit.unexplained:.2g} % of its deviation left"
    advice = f"write scale = {fit.gain:.4g} for torque in a mapping, or take load_torque for torque"
    return (Finding("torque_gain", "warning", message, advice, column="torque"),)
