"""A joint that is opened for a motion of calibration, and left at zero torque whatever happens."""

from collections.abc import Iterator
from contextlib import contextmanager

from fricomp.adapters import JointAdapter, open_adapter
from fricomp.control.loop.ending import require_stopped, stopping_on_error
from fricomp.control.loop.interruption import interrupting_on_ending_signals
from fricomp.errors import ParameterError

from .motion.context import SweepContext
from .request import CalibrationRequest
from .rigid_body import RigidBody
from .watch import SweepWatch


@contextmanager
def open_joint(request: CalibrationRequest, watch: SweepWatch | None = None) -> Iterator[SweepContext]:
    """The joint, open; zero torque and closed at the end, whatever happens.

    Until then Ctrl-C and every other signal that ends a process raise `KeyboardInterrupt`, so that the joint is stopped
    first. Outside the main thread Python hears no signal, and a warning says so.

    Args:
        request: What was asked for.
        watch: Is shown the joint, and what a sweep records.

    Raises:
        ParameterError: The backend has no such joint.
        AdapterError: The joint cannot be opened, or the last stop did not get through, whatever else has happened.
    """
    with interrupting_on_ending_signals():
        adapter: JointAdapter = open_adapter(request.backend, request.configuration)
        with _tell_opening(adapter), adapter, stopping_on_error(adapter):
            names = [joint.name for joint in adapter.capabilities.joints]
            if request.joint and request.joint not in names:
                raise ParameterError(f"no joint {request.joint!r}; this backend has {', '.join(names)}")
            body = RigidBody(request.model, names) if request.model else None
            joint = names.index(request.joint) if request.joint else 0
            if watch is not None:
                watch.attach(adapter, joint)
            yield SweepContext(adapter, joint, request.settings, body, watch)


@contextmanager
def _tell_opening(adapter: JointAdapter) -> Iterator[None]:
    try:
        yield
    finally:
        require_stopped(adapter)  # closing it has tried once more
