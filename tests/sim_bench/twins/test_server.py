"""A twin in real time answers with where its joint is, however long its process was halted before."""

import pytest

from fricomp.sim_bench.stand_in import default_joint
from fricomp.sim_bench.twins import DriveTwin, TwinServer, twin, twin_stand_in

PERIOD = 1e-3  # of the stand-in [s]


class HaltedTime:
    """A wall clock whose process was halted between two looks at it."""

    def __init__(self, halts: list[float]) -> None:
        self.now, self._halts = 100.0, iter(halts)

    def monotonic(self) -> float:
        self.now += next(self._halts, PERIOD)
        return self.now

    def sleep(self, seconds: float) -> None:
        pass


class AskedTwin(DriveTwin):
    """Notes how far its joint has come whenever it is asked; ends its server after some questions."""

    server: TwinServer

    def __init__(self, questions: int) -> None:
        super().__init__(twin_stand_in(default_joint()), ())
        self.answered: list[float] = []
        self.left = questions

    def _pump(self) -> int:
        self.answered.append(self.stand_in.time_ns * 1e-9)
        self.left -= 1
        if not self.left:
            self.server._stop.set()
        return 0

    def close(self) -> None:
        pass


@pytest.mark.parametrize(("halt", "caught_up"), [(0.03, 0.03), (0.09, 0.09), (5.0, twin.LARGEST_LAG)])
def test_what_a_halted_twin_answers_is_never_older_than_its_answer(
    halt: float, caught_up: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(twin, "time", HaltedTime([0.0, PERIOD, halt, PERIOD]))
    asked = AskedTwin(4)
    asked.server = TwinServer(asked, real_time=True)
    with asked.server:
        asked.server.wait()
    assert asked.server.error is None
    first, second, third, _ = asked.answered
    assert second - first == pytest.approx(caught_up, abs=1.5 * PERIOD)
    assert third - second == pytest.approx(PERIOD, abs=1.5 * PERIOD)
