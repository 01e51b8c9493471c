"""The blind side of a proof on arms: examines the arm in the working folder and writes what came out.

Run as `python -m fricomp.sim_bench.studies.kit.blind_arm`; it is `fricomp diagnose FOLDER --simulation arm.xml` without
its report. It imports nothing of the generator and sees nothing but the files beside it.
"""

import sys
from pathlib import Path

from fricomp.arm import examine_arm, save_arm_record
from fricomp.errors import FricompError
from fricomp.recording import read_recording

from .blind_diagnosis import ANSWER


def main() -> int:
    """Examine the arm in the working folder; returns the exit status."""
    try:
        recordings = [read_recording(path) for path in sorted(Path().glob("*.csv"))]
        save_arm_record(examine_arm(recordings, "arm.xml").record, Path(ANSWER))
    except FricompError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
