"""The blind side of a proof: diagnoses the case in the working folder and writes what came out.

Run as `python -m fricomp.sim_bench.studies.kit.blind_diagnosis`; it is `fricomp diagnose` without its report. It
imports nothing of the generator and sees nothing but the files beside it.
"""

import sys
from pathlib import Path

from fricomp.diagnosis import diagnose, save_diagnosis
from fricomp.errors import FricompError
from fricomp.model import load_model
from fricomp.recording import read_recording

ANSWER, MOTION = "diagnosis.json", "motion.csv"


def main() -> int:
    """Diagnose the case in the working folder; returns the exit status."""
    friction, simulation = Path("friction.json"), Path("joint.xml")
    try:
        diagnosis = diagnose(
            [read_recording(path) for path in sorted(Path().glob("recording*.parquet"))],
            simulation if simulation.exists() else None,
            friction=load_model(friction) if friction.exists() else None,
        )
        save_diagnosis(diagnosis, ANSWER)
    except FricompError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    if diagnosis.motion is not None:
        names = list(diagnosis.motion)
        rows = zip(*(diagnosis.motion[name].tolist() for name in names), strict=True)
        text = "\n".join([",".join(names), *(",".join(map(repr, row)) for row in rows)])
        Path(MOTION).write_text(text + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
