"""A twin in real time answers with where its joint is, however long its process was halted before."""

from collections.abc import Iterator

import pytest

from fricomp.sim_bench.stand_in import default_joint
from fricomp.sim_bench.twins import DriveTwin, TwinServer, twin, twin_stand_in

PERIOD = 1e-3  # of the stand-in [s]


class HaltedTime:
    """A wall clock of a process that is halted while it sleeps."""

    def __init__(self, halts: list[float]) -> None:
        self.now, self._halts = 100.0, iter(halts)

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += next(self._halts, PERIOD)


class AskedTwin(DriveTwin):
    """Notes how far its joint has come whenever it is asked; ends its server after some questions."""

    server: TwinServer

    def __init__(self, questions: int) -> None:
        super().__init__(twin_stand_in(default_joint()), ())
        self.answered: list[float] = []
        self._questions = questions

    def _pump(self) -> int:
        self.answered.append(self.stand_in.time_ns * 1e-9)
        if len(self.answered) == self._questions:
            self.server._stop.set()
        return 0

    def close(self) -> None:
        pass

    def serve(self) -> Iterator[float]:
        """Serve to the end; gives how far the joint came from each question to the next."""
        self.server = TwinServer(self, real_time=True)
        with self.server:
            self.server.wait()
        assert self.server.error is None
        return (after - before for before, after in zip(self.answered, self.answered[1:], strict=False))


@pytest.mark.parametrize(("halt", "caught_up"), [(0.03, 0.03), (0.09, 0.09), (5.0, twin.LARGEST_LAG)])
def test_what_a_halted_twin_answers_is_never_older_than_its_answer(
    halt: float, caught_up: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(twin, "time", HaltedTime([halt, PERIOD]))
    came = list(AskedTwin(3).serve())
    assert came == pytest.approx([caught_up, PERIOD], abs=1.5 * PERIOD)


def test_a_twin_that_is_halted_while_it_catches_up_catches_up_with_that_too(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = HaltedTime([0.01])
    monkeypatch.setattr(twin, "time", clock)
    asked = AskedTwin(2)
    advance, halts = asked.advance, iter([0.0, 0.0, 0.0, 0.03])

    def halted() -> None:
        advance()
        clock.now += next(halts, 0.0)

    monkeypatch.setattr(asked, "advance", halted)
    assert list(asked.serve()) == pytest.approx([0.04], abs=1.5 * PERIOD)


def test_a_machine_slower_than_the_joint_still_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = HaltedTime([])
    monkeypatch.setattr(twin, "time", clock)
    asked = AskedTwin(3)
    advance = asked.advance

    def slowly() -> None:
        advance()
        clock.now += 2.0 * PERIOD

    monkeypatch.setattr(asked, "advance", slowly)
    assert max(asked.serve()) <= twin.LARGEST_LAG + PERIOD
