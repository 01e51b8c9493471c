"""Work for fleets whose outcome is known, and workers that die."""

import os
import time
from pathlib import Path

from fricomp.errors import DiagnosisError
from fricomp.fleet import FleetJoint, FleetRow


def die_the_first_time() -> None:
    """Kill this worker the first time anybody comes here, as a machine that fails would."""
    marker = Path(os.environ["FRICOMP_TEST_MARKER"])
    if not marker.exists():
        marker.write_text("dead")
        os._exit(1)


def count_bytes(joint: FleetJoint, out: Path) -> FleetRow:
    """Writes a report that says how large the recordings are; refuses empty ones."""
    sizes = [len(path.read_bytes()) for path in joint.recordings]
    if not all(sizes):
        raise DiagnosisError("the recording is empty")
    (out / "report.html").write_text(f"{joint.name}: {sizes}")
    return {"bytes": sum(sizes), "simulated": joint.simulation is not None and joint.simulation.exists()}


def count_bytes_after_a_death(joint: FleetJoint, out: Path) -> FleetRow:
    """The same; the first worker that is asked dies."""
    die_the_first_time()
    return count_bytes(joint, out)


def divide_by_zero(joint: FleetJoint, out: Path) -> FleetRow:
    """Fails in a way that nobody foresaw."""
    return {"bytes": 1 // (len(joint.name) - 1)}


def leave_a_file(path: Path) -> None:
    """Tells that this call was begun."""
    path.touch()


def tell_and_wait(begun: Path) -> None:
    """Tells the number of this process, and lasts a minute."""
    part = begun.with_suffix(".part")
    part.write_text(str(os.getpid()))
    part.rename(begun)
    time.sleep(60.0)


def wait_for_a_file(begun: Path | None, end: Path) -> None:
    """Tells that this call was begun, and lasts until `end` exists, a minute at most."""
    if begun is not None:
        begun.touch()
    deadline = time.monotonic() + 60.0
    while not end.exists():
        if time.monotonic() > deadline:
            raise TimeoutError(f"{end} does not come")
        time.sleep(0.01)
