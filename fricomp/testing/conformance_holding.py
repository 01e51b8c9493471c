"""A drive that somebody else holds: it is asked, refused and left alone, unless it is taken over in so many words."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from fricomp.errors import DriveHeld
from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import flattened, opened, run, start, stopped

__all__ = ["HoldingConformance"]

Step = Callable[[AdapterRig], object]


def _start_and_end(rig: AdapterRig) -> None:
    """A whole motion before, after which the drives rest and everything is configured."""
    opened(rig)
    start(rig)
    run(rig, 3)
    rig.adapter.disable()
    rig.clock.advance(rig.period)
    assert not any(rig.adapter.read_energised())


def _configure_position(rig: AdapterRig) -> None:
    modes = rig.adapter.capabilities.modes
    rig.adapter.configure("position" if "position" in modes else "torque", rig.period)


STEPS: dict[str, tuple[Step, Step]] = {
    "open": (lambda rig: None, lambda rig: rig.adapter.open()),
    "clear_faults": (opened, lambda rig: rig.adapter.clear_faults()),
    "configure": (opened, lambda rig: rig.adapter.configure("torque", rig.period)),
    "configure anew": (_start_and_end, _configure_position),
    "enable": (_start_and_end, lambda rig: rig.adapter.enable()),
}
"""What is done before somebody else takes the drive, and what must be refused then."""


class HoldingConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

    @pytest.mark.parametrize("step", STEPS)
    def test_a_drive_that_somebody_else_holds_is_left_alone(self, rig: AdapterRig, step: str) -> None:
        prepare, refused = STEPS[step]
        prepare(rig)
        rig.hold(0)
        with _left_alone(rig):
            with pytest.raises(DriveHeld):
                refused(rig)
            rig.adapter.safe_stop()
        before = rig.energised(), rig.applied_torque()
        rig.adapter.close()  # what was written into drives that nobody holds may be taken back
        assert (rig.energised(), rig.applied_torque()) == before

    def test_a_held_drive_is_taken_over_at_zero_torque_if_it_is_said(self, rig: AdapterRig) -> None:
        rig.hold(0)
        rig.adapter.open(take_over=True)
        assert len(rig.adapter.taken_over) == 1
        assert stopped(rig)
        assert not any(rig.energised())
        rig.adapter.close()
        opened(rig)
        assert not rig.adapter.taken_over
        start(rig)
        assert run(rig, 3)

    def test_what_is_said_about_energy_is_read_from_the_drives(self, rig: AdapterRig) -> None:
        opened(rig)
        assert not any(rig.adapter.read_energised())
        rig.hold(0)
        with _left_alone(rig):
            assert list(map(bool, rig.adapter.read_energised())) == rig.energised()


@contextmanager
def _left_alone(rig: AdapterRig) -> Iterator[None]:
    """The drives get nothing but requests, and are as they were."""
    before = rig.energised(), rig.applied_torque()
    rig.link.sent.clear()
    rig.link.recording = True
    yield
    rig.link.recording = False
    written = [traffic for traffic in flattened(rig.link.sent) if not rig.is_read(traffic)]
    assert written == [], f"the drives were written to: {written}"
    assert (rig.energised(), rig.applied_torque()) == before
