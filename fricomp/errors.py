"""The error tree: everything this library raises derives from `FricompError`.

FricompError
├── ParameterError (ValueError)            a physical parameter or argument is out of its domain
├── MissingExtraError (ImportError)        an optional package is needed and not installed
├── ModelFileError (ValueError)            a model file is damaged, foreign or newer
├── RecordingError (ValueError)            a recording cannot be read or used as it is
├── IdentificationError                    an identification cannot give an answer
├── DiagnosisError                         a diagnosis cannot be carried out
│   └── SimulationFileError (ParameterError) an MJCF or URDF file cannot be read
├── ExportError                            a model cannot be written in the wanted format
├── OutputError (OSError)                  results cannot be written, or would replace what is not theirs
├── SweepAborted                           a motion on a joint was stopped before its end
├── SafetyTrip                             the safety gate has latched
└── AdapterError
    ├── AdapterConfigurationError (ValueError)   a bus, joint or limit is configured wrongly
    ├── AdapterConnectionError (ConnectionError) the bus or the drive cannot be reached
    ├── AdapterTimeout (TimeoutError)            the drive did not answer in time
    ├── AdapterValueError (ValueError)           a command that must not reach a drive
    ├── DriveFault                               the drive reports a fault
    └── DriveHeld                                the drive is energised by somebody else
"""


class FricompError(Exception):
    """Base of every error of this library."""


class ParameterError(FricompError, ValueError):
    """A physical parameter or an argument is outside its domain."""


class MissingExtraError(FricompError, ImportError):
    """An optional package is needed that is not installed.

    Args:
        package: The package that could not be imported.
        extra: The extra of fricomp that brings it; empty where none does, because nothing but this call needs it.
    """

    def __init__(self, package: str, extra: str = "") -> None:
        how = f"pip install '.[{extra}]' in the checkout" if extra else f"pip install {package}"
        super().__init__(f"{package} is needed here and not installed: {how}")


class ModelFileError(FricompError, ValueError):
    """A model file is damaged, foreign or written by a newer version."""


class RecordingError(FricompError, ValueError):
    """A recording cannot be read, or cannot be used as it is."""


class IdentificationError(FricompError):
    """An identification cannot give an answer from this data."""


class DiagnosisError(FricompError):
    """A diagnosis cannot be carried out."""


class SimulationFileError(DiagnosisError, ParameterError):
    """An MJCF or URDF file cannot be read, or lacks what is asked of it."""


class ExportError(FricompError):
    """A model cannot be written in the wanted format."""


class OutputError(FricompError, OSError):
    """Results cannot be written: the disk, somebody else's files, or another process is in the way."""


class SweepAborted(FricompError):
    """A motion on a joint was stopped before its end; the joint is at zero torque."""


class SafetyTrip(FricompError):
    """The safety gate has latched; only an explicit reset opens it again."""


class AdapterError(FricompError):
    """Base of every error of an adapter."""


class AdapterConfigurationError(AdapterError, ValueError):
    """A bus, a joint or a limit is configured wrongly."""


class AdapterConnectionError(AdapterError, ConnectionError):
    """The bus or the drive cannot be reached, or was lost."""


class AdapterTimeout(AdapterError, TimeoutError):
    """The drive did not answer in time."""


class AdapterValueError(AdapterError, ValueError):
    """A command that must not reach a drive, such as a torque that is not finite."""


class DriveFault(AdapterError):
    """The drive reports a fault."""


class DriveHeld(AdapterError):
    """The drive is energised by somebody else; nothing has been written to it."""
