"""Joint friction: calibrate it, compensate it in real time, and find the physics a simulation leaves out.

- `calibrate` moves a joint and identifies its friction; `identify` does it from data that you have already.
- `Compensator` gives the torque that overcomes friction in a control loop; `ControlLoop` is such a loop.
- `evaluate` measures the errors of a model over a recording, in torque and in motion.
- `examine_arm` says what the links of an arm weigh, and what is missing in each of its joints.
- `diagnose` says what physics a simulation leaves out, from recordings of the real joint.
- `read_recording`, `load_model` and `save_model` read and write files.

Results print as one line; `result.summary()` is a text with everything, `result.plot()` a picture.
"""

from typing import TYPE_CHECKING, Any

from fricomp.errors import FricompError
from fricomp.version import __version__ as __version__

if TYPE_CHECKING:
    from fricomp.api.calibrate import calibrate
    from fricomp.api.diagnose import diagnose
    from fricomp.api.examine_arm import examine_arm
    from fricomp.api.identify import identify
    from fricomp.calibration import identify_dynamic
    from fricomp.calibration.sweep import CalibrationOptions, SweepSettings
    from fricomp.control import Compensator, ControlLoop, JointLimits, LoopDynamics, SafetyGate, check_loop
    from fricomp.evaluation import Evaluation, evaluate
    from fricomp.laws import FrictionLaw, OperatingPoint
    from fricomp.model import FrictionModel, load_model, save_model
    from fricomp.recording import Recording, read_recording, write_recording

__all__ = [
    "CalibrationOptions",
    "Compensator",
    "ControlLoop",
    "Evaluation",
    "FricompError",
    "FrictionLaw",
    "FrictionModel",
    "JointLimits",
    "LoopDynamics",
    "OperatingPoint",
    "Recording",
    "SafetyGate",
    "SweepSettings",
    "calibrate",
    "check_loop",
    "diagnose",
    "evaluate",
    "examine_arm",
    "identify",
    "identify_dynamic",
    "load_model",
    "read_recording",
    "save_model",
    "write_recording",
]

_CONTROL, _RECORDING, _SWEEP = "fricomp.control", "fricomp.recording", "fricomp.calibration.sweep"
_LAWS, _MODEL = "fricomp.laws", "fricomp.model"
_HOMES = {
    "CalibrationOptions": (_SWEEP, "calibrate"),
    "Compensator": (_CONTROL, ""),
    "ControlLoop": (_CONTROL, ""),
    "Evaluation": ("fricomp.evaluation", "calibrate"),
    "FrictionLaw": (_LAWS, ""),
    "FrictionModel": (_MODEL, ""),
    "JointLimits": (_CONTROL, ""),
    "LoopDynamics": (_CONTROL, ""),
    "OperatingPoint": (_LAWS, ""),
    "Recording": (_RECORDING, ""),
    "SafetyGate": (_CONTROL, ""),
    "SweepSettings": (_SWEEP, "calibrate"),
    "calibrate": ("fricomp.api.calibrate", "calibrate"),
    "check_loop": (_CONTROL, ""),
    "diagnose": ("fricomp.api.diagnose", "diagnose"),
    "evaluate": ("fricomp.evaluation", "calibrate"),
    "examine_arm": ("fricomp.api.examine_arm", "diagnose"),
    "identify": ("fricomp.api.identify", "calibrate"),
    "identify_dynamic": ("fricomp.calibration", "calibrate"),
    "load_model": (_MODEL, ""),
    "read_recording": (_RECORDING, ""),
    "save_model": (_MODEL, ""),
    "write_recording": (_RECORDING, ""),
}
"""What is imported when it is first asked for: its module, and the extra that brings what the module imports.

Nothing heavy is imported before, so that Ctrl-C finds a command at work that says it was interrupted.
"""


def __getattr__(name: str) -> Any:
    """Import a name of `_HOMES` from where it lives; from then on it is an attribute like any other."""
    if name not in _HOMES:
        raise AttributeError(f"module 'fricomp' has no attribute {name!r}")
    from importlib import import_module

    module, extra = _HOMES[name]
    try:
        globals()[name] = found = getattr(import_module(module), name)
    except ModuleNotFoundError as error:
        if not extra or (error.name or "").startswith("fricomp"):
            raise
        from fricomp.errors import MissingExtraError

        raise MissingExtraError(error.name or "a package", extra) from error
    return found


def __dir__() -> list[str]:
    """The public names, those that are not imported yet among them."""
    return sorted([*__all__, "__version__"])
