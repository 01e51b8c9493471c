"""What can happen to a bus and its drives, on every protocol it can happen to: zero torque within the watchdog's time,
one clear error, and nothing enables again by itself."""

from __future__ import annotations

from collections import deque
from typing import Any

import can
import pytest

from fricomp.adapters.link import PythonCanLink
from fricomp.control import ControlLoop, PositionController, SineReference
from fricomp.errors import AdapterConfigurationError, AdapterConnectionError, AdapterError, FricompError, SafetyTrip
from fricomp.joint import JointCommand, JointFeedback, await_feedback
from fricomp.sim_bench.studies.adapters.bench import PERIOD, PROTOCOLS, TORQUE_LIMIT, AdapterBench, make_bench
from tests.adapters import late_link
from tests.adapters.late_link import make_late_bench

CAN_PROTOCOLS = ("canopen", "mit", "odrive")
N_JOINTS = 2
BUS_OFF_FRAME = can.Message(arbitration_id=0x40, is_error_frame=True, dlc=8, data=bytes(8))


def cycle(bench: AdapterBench, share: float = 0.5) -> bool:
    command = JointCommand(N_JOINTS)
    command.torque[:] = [share * TORQUE_LIMIT] * N_JOINTS
    sent = bench.adapter.write(command)
    bench.clock.advance(PERIOD)
    bench.adapter.read_into(JointFeedback(N_JOINTS))
    return sent


def started(protocol: str) -> AdapterBench:
    bench = make_bench(protocol, N_JOINTS)
    bench.start()
    for _ in range(5):
        assert cycle(bench)
    assert min(abs(axis.torque) for axis in bench.axes) > 0.4 * TORQUE_LIMIT
    return bench


def go_on(bench: AdapterBench) -> list[FricompError]:
    """Cycles for a second, as a loop that stops when it is told to; the errors that came."""
    try:
        for _ in range(round(1.0 / PERIOD)):
            if not cycle(bench):
                break
    except FricompError as error:
        return [error]
    return []


def assert_dead(bench: AdapterBench) -> None:
    """No torque once the watchdog's time is over, and nothing that would bring it back but clearing and enabling."""
    watchdog = bench.adapter.capabilities.watchdog
    assert watchdog is not None
    bench.clock.advance(watchdog.timeout + 2.0 * PERIOD)
    assert all(axis.torque == 0.0 for axis in bench.axes)
    assert not bench.adapter.enabled
    assert not bench.adapter.write(JointCommand(N_JOINTS))
    with pytest.raises(SafetyTrip):
        bench.adapter.enable()
    bench.clock.advance(PERIOD)
    assert all(axis.torque == 0.0 for axis in bench.axes)


def assert_comes_back(bench: AdapterBench) -> None:
    """By the user's own word, and not before."""
    bench.adapter.clear_faults()
    bench.adapter.enable()
    bench.clock.advance(PERIOD)
    assert all(axis.torque == pytest.approx(0.0, abs=0.01) for axis in bench.axes)
    assert cycle(bench)


class Controller:
    """A python-can bus whose controller can go bus-off, and has to be told to come back.

    Args:
        line: To the twin.
        way: How its interface tells: by an error frame, by its state, or by an error as when a network is set down.
    """

    def __init__(self, line: Any, way: str) -> None:
        self._line, self._way = line, way
        self._frames: deque[can.Message] = deque()
        self.is_off = self._told = False

    def send(self, message: can.Message, timeout: float | None = None) -> None:
        if self.is_off and self._way == "state":
            return  # into its own queue, which nothing leaves
        if self.is_off:
            raise can.CanOperationError(
                "Network is down" if self._way == "network down" else "the controller is bus-off"
            )
        self._line.to_twin.append(message)
        self._line.on_sent()

    def recv(self, timeout: float | None = None) -> can.Message | None:
        if self.is_off and self._way == "network down":
            raise can.CanOperationError("Network is down")
        if self.is_off:
            told, self._told = self._told, True
            return None if told or self._way == "state" else BUS_OFF_FRAME
        for frame in self._line.link.receive():
            self._frames.append(
                can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=frame.extended)
            )
        return self._frames.popleft() if self._frames else None

    @property
    def state(self) -> can.BusState:
        return can.BusState.ERROR if self.is_off and self._way == "state" else can.BusState.ACTIVE

    def flush_tx_buffer(self) -> None:
        raise NotImplementedError

    def shutdown(self) -> None:
        """Nothing is held."""


WAYS = {"error frame": "bus-off", "state": "the CAN controller is bus-off", "network down": "Network is down"}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("protocol", CAN_PROTOCOLS)
def test_bus_off_is_one_clear_error_and_zero_torque_by_the_watchdogs(protocol: str, way: str) -> None:
    bench = make_bench(protocol, N_JOINTS)
    controller: Any = Controller(bench.line, way)
    bench.adapter._open_link = lambda: PythonCanLink(controller)  # type: ignore[attr-defined]
    bench.start()
    for _ in range(5):
        assert cycle(bench)
    controller.is_off = True
    (error,) = go_on(bench)
    assert isinstance(error, AdapterConnectionError)
    assert WAYS[way] in str(error)
    record = bench.adapter.gate.trip_record
    assert record is not None
    assert record.reason == "link"
    assert_dead(bench)
    controller.is_off = False
    bench.clock.advance(0.2)
    assert not cycle(bench)
    assert all(axis.torque == 0.0 for axis in bench.axes)
    assert_comes_back(bench)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_a_state_that_has_waited_to_be_read_is_old(protocol: str) -> None:
    bench = started(protocol)
    command, feedback = JointCommand(N_JOINTS), JointFeedback(N_JOINTS)
    assert bench.adapter.write(command)
    asked = bench.clock.now_ns()
    bench.clock.advance(0.04)  # the loop is held up, and the answer waits in a buffer
    assert bench.adapter.read_into(feedback)
    assert feedback.time_ns == asked
    record = bench.adapter.gate.trip_record
    assert record is not None
    assert record.reason == "stale"
    assert not bench.adapter.write(command)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_a_loop_waits_for_drives_that_answer_late(protocol: str) -> None:
    bench = make_late_bench(protocol)
    bench.adapter.open()
    bench.adapter.configure("torque", PERIOD)
    feedback = JointFeedback(1)
    await_feedback(bench.adapter, feedback, PERIOD)
    reference = SineReference([0.1], 1.0, feedback.position)
    loop = ControlLoop(bench.adapter, reference, PositionController.from_bandwidth([0.01], 1.0), period=PERIOD)
    result = loop.run(0.5)
    assert (result.cycles, result.trip) == (round(0.5 / PERIOD), None)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_a_bus_whose_answers_are_stale_when_they_come_is_refused(
    protocol: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(late_link, "LATENCY_NS", 43_000_000)
    adapter = make_late_bench(protocol).adapter
    adapter.open()
    with pytest.raises(AdapterConfigurationError, match=r"answers take 4[34]"):
        adapter.configure("torque", PERIOD)
    with pytest.raises(AdapterError, match="not configured"):
        adapter.enable()


@pytest.mark.parametrize("protocol", ["canopen", "dynamixel", "moteus", "odrive"])
def test_a_joint_that_was_moved_by_hand_is_held_where_it_is(protocol: str) -> None:
    bench = make_late_bench(protocol)
    adapter, feedback = bench.adapter, JointFeedback(1)
    adapter.open()
    adapter.configure("position", PERIOD)
    for _ in range(5):  # the answer to the last request is left waiting
        bench.clock.advance(0.006)
        adapter.read_into(feedback)
    assert feedback.position[0] == pytest.approx(0.0, abs=0.01)
    bench.axes[0].position = 1.0
    bench.clock.advance(5.0)
    references: list[float] = []
    bench.axes[0].command = lambda torque, velocity=0.0, position=0.0: references.append(position)  # type: ignore[method-assign]
    adapter.enable()
    command = JointCommand(1)
    command.position[0] = 1.0
    assert adapter.write(command)
    assert references == pytest.approx([1.0] * len(references), abs=0.01)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_one_lost_node_stops_all_joints_and_lets_go_itself(protocol: str) -> None:
    bench = started(protocol)
    bench.twin.drives = bench.twin.drives[:1]
    assert len(go_on(bench)) <= 1
    record = bench.adapter.gate.trip_record
    assert record is not None
    assert record.reason in ("stale", "link", "drive_fault")
    assert bench.axes[0].torque == 0.0
    assert_dead(bench)


class CutLink:
    """Lets only a part of one command through, and then nothing more, until plugged in again."""

    def __init__(self, link: Any) -> None:
        self._link = link
        self.cut: float | None = None
        self.silent = False

    def send(self, traffic: Any) -> None:
        if self.silent:
            return
        if self.cut is not None:
            traffic, self.cut, self.silent = traffic[: max(1, round(self.cut * len(traffic)))], None, True
        self._link.send(traffic)

    def receive(self) -> Any:
        traffic = self._link.receive()
        return traffic[:0] if self.silent else traffic

    def discard_output(self) -> None:
        self._link.discard_output()

    def close(self) -> None:
        self._link.close()


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_a_cable_pulled_in_mid_frame_ends_in_zero_torque_and_harms_nothing_later(protocol: str, share: float) -> None:
    bench = make_bench(protocol, N_JOINTS)
    link = CutLink(bench.link)
    bench.adapter._open_link = lambda: link  # type: ignore[attr-defined]
    bench.start()
    for _ in range(5):
        assert cycle(bench)
    link.cut = share
    assert len(go_on(bench)) <= 1
    assert max(axis.largest_torque for axis in bench.axes) <= TORQUE_LIMIT
    assert_dead(bench)
    link.silent = False
    bench.clock.advance(0.2)
    assert not cycle(bench)
    assert all(axis.torque == 0.0 for axis in bench.axes)
    assert_comes_back(bench)


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_stop_drops_what_still_waits_to_be_sent_before_it_sends(
    protocol: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = started(protocol)
    link: Any = bench.adapter._link  # type: ignore[attr-defined]
    order: list[str] = []
    discard, send = link.discard_output, link.send

    def discarding() -> None:
        order.append("discard")
        discard()

    def sending(data: Any) -> None:
        order.append("send")
        send(data)

    monkeypatch.setattr(link, "discard_output", discarding)
    monkeypatch.setattr(link, "send", sending)
    bench.adapter.safe_stop("operator")
    assert "discard" in order
    assert order.index("discard") < order.index("send")


def test_what_a_bus_counts_as_damaged_is_told_by_health() -> None:
    class NoisyBus:
        n_damaged = 2  # counted by the interface itself

        def __init__(self) -> None:
            self.coming = [can.Message(arbitration_id=0x4, is_error_frame=True, dlc=8, data=bytes(8)), None]

        def recv(self, timeout: float) -> can.Message | None:
            return self.coming.pop(0)

    link: Any = PythonCanLink(NoisyBus())  # type: ignore[arg-type]
    assert list(link.receive()) == []
    assert link.n_errors == 3
    adapter: Any = make_bench("mit", 1).adapter
    adapter._link = link
    assert adapter.health()["bus_errors"] == 3.0
