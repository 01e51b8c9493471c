"""One joint's time series: its files, its checks, and the ways other formats come in."""

from fricomp.recording.checks.checks import CheckedRecording, check_recording
from fricomp.recording.conversion import NamedRecording, convert
from fricomp.recording.file import read_checked, read_recording, write_recording
from fricomp.recording.finding import Finding, RecordingWarning, raise_errors
from fricomp.recording.mapping import Mapping, list_mappings, load_mapping
from fricomp.recording.metadata import RecordingMetadata
from fricomp.recording.public import find_public_data, read_public, read_public_named
from fricomp.recording.recording import CHANNELS, OPTIONAL_CHANNELS, REQUIRED_CHANNELS, Recording, concatenate
from fricomp.recording.resampling import resample
from fricomp.recording.writer import Block, RecordingWriter, read_blocks

__all__ = [
    "CHANNELS",
    "OPTIONAL_CHANNELS",
    "REQUIRED_CHANNELS",
    "Block",
    "CheckedRecording",
    "Finding",
    "Mapping",
    "NamedRecording",
    "Recording",
    "RecordingMetadata",
    "RecordingWarning",
    "RecordingWriter",
    "check_recording",
    "concatenate",
    "convert",
    "find_public_data",
    "list_mappings",
    "load_mapping",
    "raise_errors",
    "read_blocks",
    "read_checked",
    "read_public",
    "read_public_named",
    "read_recording",
    "resample",
    "write_recording",
]
