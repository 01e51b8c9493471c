"""The live page: what it shows, who may see it, and that its stop is the gate's own."""

from __future__ import annotations

import http.client
import json
import math
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

from fricomp.adapters import JointAdapter, open_adapter
from fricomp.control import ControlLoop, LoopResult, PositionController, SineReference
from fricomp.errors import SafetyTrip
from fricomp.joint import JointFeedback
from fricomp.live.curve import fit_curve
from fricomp.live.feed import LiveFeed
from fricomp.live.ring import CycleRing
from fricomp.live.server import LiveState

PERIOD = 1e-3


@pytest.fixture(scope="module")
def feed() -> Iterator[LiveFeed]:
    """A page for all tests that do not press its stop: its process takes seconds to come up."""
    with LiveFeed("Elbow") as shown:
        yield shown


def ask(feed: LiveFeed, path: str, *, method: str = "GET", host: str = "127.0.0.1") -> tuple[int, bytes]:
    address = urlsplit(feed.address)
    connection = http.client.HTTPConnection("127.0.0.1", address.port or 0, timeout=30)
    connection.request(method, path, headers={"Host": f"{host}:{address.port}"})
    answer = connection.getresponse()
    return answer.status, answer.read()


def state_of(feed: LiveFeed) -> dict[str, Any]:
    status, content = ask(feed, f"{urlsplit(feed.address).path}state?since=0")
    assert status == 200
    return dict(json.loads(content))


def make_loop(adapter: JointAdapter) -> ControlLoop:
    controller = PositionController.from_bandwidth([0.1], 5.0)
    return ControlLoop(adapter, SineReference([0.3], 0.5, [0.0]), controller, period=PERIOD)


def test_the_ring_gives_the_newest_rows_thinned_out() -> None:
    ring = CycleRing(2)
    other = CycleRing(2, ring.name)
    feedback = JointFeedback(2)
    for row in range(40_000):
        feedback.position[:] = [float(row), -float(row)]
        ring.write(0.001 * row, feedback, [1.0, 2.0])
    count, rows = other.read(39_000, 100)
    assert count == 40_000
    assert len(rows) == 100
    assert rows[-1][:3] == (0.001 * 39_999, 39_999.0, -39_999.0)
    assert all(later[0] > earlier[0] for earlier, later in pairwise(rows))
    assert len(other.read(0, 10**6)[1]) <= 16_384 // 2
    assert rows[-1][-2:] == (1.0, 2.0)
    other.close()
    ring.close()


@pytest.mark.parametrize("path", ["/", "/state", "/wrong/", "/wrong/state", "/wrong/stop"])
def test_who_does_not_know_the_token_gets_nothing(feed: LiveFeed, path: str) -> None:
    assert ask(feed, path)[0] == 404
    assert ask(feed, path, method="POST")[0] == 404
    assert not feed.stopped.is_set()


def test_another_name_for_this_machine_gets_nothing(feed: LiveFeed) -> None:
    assert ask(feed, urlsplit(feed.address).path, host="attacker.example")[0] == 404


@pytest.mark.parametrize(("method", "path"), [("GET", "stop"), ("POST", "state"), ("POST", ""), ("POST", "enable")])
def test_nothing_but_the_stop_can_be_done(feed: LiveFeed, method: str, path: str) -> None:
    assert ask(feed, f"{urlsplit(feed.address).path}{path}", method=method)[0] == 404
    assert not feed.stopped.is_set()


def test_the_page_needs_nothing_from_elsewhere(feed: LiveFeed) -> None:
    status, content = ask(feed, urlsplit(feed.address).path)
    assert status == 200
    assert b"http" not in content
    assert b"src=" not in content


def test_the_motion_is_shown_as_it_comes(feed: LiveFeed) -> None:
    with open_adapter("sim", {"backend": "sim"}) as adapter:
        feed.attach(adapter)
        result = make_loop(adapter).run(0.5)
    state = state_of(feed)
    assert state["joints"] == [{"name": "joint", "unit": "rad", "torque_unit": "N·m"}]
    assert state["count"] >= 499
    shown = {round(row[0], 6): row for row in state["rows"]}
    assert result.cycles == 500
    assert max(shown) == pytest.approx(0.5, abs=0.01)
    assert state["rows"][-1][1] == pytest.approx(result.log.signal("position")[-1, 0], abs=1e-3)


def press_stop(feed: LiveFeed) -> None:
    assert ask(feed, f"{urlsplit(feed.address).path}stop", method="POST")[0] == 200


def press_in_motion(
    backend: str, feed: LiveFeed, press: Callable[[LiveFeed], None]
) -> tuple[list[tuple[int, float]], LoopResult]:
    """A motion in which the stop is pressed after a second; the torques that went out to the drive, with times."""
    sent: list[tuple[int, float]] = []
    adapter = open_adapter(backend, {"backend": backend})
    write: Callable[[Any, Any], None] = adapter._write

    def keep(command: Any, mode: Any) -> None:
        sent.append((adapter.clock.now_ns(), command.torque[0]))
        write(command, mode)

    adapter._write = keep  # type: ignore[method-assign]
    with adapter:
        feed.attach(adapter)
        begun, show = adapter.clock.now_ns(), adapter.tap
        assert show is not None

        def press_once(feedback: JointFeedback, admitted: Sequence[float]) -> None:
            show(feedback, admitted)
            if adapter.clock.now_ns() > begun + 10**9 and not feed.stopped.is_set():
                press(feed)
                assert feed.stopped.wait(60.0)

        adapter.tap = press_once
        result = make_loop(adapter).run(5.0)
    return sent, result


def require_prompt(sent: Sequence[tuple[int, float]], result: LoopResult) -> None:
    """The joint was in mid-motion, and two periods after the stop there is no torque on it any more."""
    assert result.trip is not None
    assert (result.trip.reason, result.trip.detail) == ("stop", "stopped on the live page")
    pressed = result.trip.time_ns or 0
    assert max(abs(torque) for time, torque in sent[-100:] if time < pressed) > 0.05
    assert [time for time, torque in sent if torque != 0.0 and time > pressed + 2e9 * PERIOD] == []
    assert result.cycles < 5.0 / PERIOD


@pytest.mark.parametrize("backend", ["sim", "twin-canopen", "twin-moteus"])
def test_a_stop_in_mid_motion_is_zero_torque_within_two_periods(backend: str) -> None:
    pytest.importorskip("can")
    with LiveFeed("Elbow") as feed:
        require_prompt(*press_in_motion(backend, feed, press_stop))
        with pytest.raises(SafetyTrip, match="live page"), open_adapter(backend, {"backend": backend}) as other:
            feed.attach(other)  # nothing moves any more under this page


def test_a_page_that_is_gone_holds_nothing_up() -> None:
    with LiveFeed("Elbow") as feed, open_adapter("sim", {"backend": "sim"}) as adapter:
        feed._process.kill()
        feed._process.join()
        feed.attach(adapter)
        for number in range(2000):  # more than wait for the page at most
            feed.show_progress(f"step {number}", 0.1)
        result = make_loop(adapter).run(0.2)
        assert (result.cycles, result.trip) == (200, None)


def test_a_sweep_fills_the_curve_and_lists_what_is_rejected() -> None:
    velocity = np.concatenate([np.geomspace(0.02, 2.0, 10), -np.geomspace(0.02, 2.0, 10)])
    torque = np.sign(velocity) * (0.3 + 0.2 * np.exp(-((velocity / 0.1) ** 2)) + 0.05 * np.abs(velocity))
    noisy = torque + 1e-3 * np.random.default_rng(3).standard_normal(20)
    curve = fit_curve(list(zip(velocity.tolist(), noisy.tolist(), strict=True)))
    assert curve is not None
    for name, sign in (("forward", 1.0), ("reverse", -1.0)):
        at, fitted, reach = np.array(curve[name]).T
        truth = sign * (0.3 + 0.2 * np.exp(-((at / 0.1) ** 2)) + 0.05 * np.abs(at))
        assert np.all(np.abs(fitted - truth) < 0.01)
        assert np.all((reach > 0.0) & (reach < 0.02))
    assert fit_curve([(1.0, 0.3), (-1.0, -0.3)]) is None


def test_the_state_says_how_long_it_takes() -> None:
    state = LiveState("Elbow")
    assert state.answer(0)["left"] is None
    state.take("progress", {"text": "with compensation", "done": 0.0, "duration": 20.5})
    assert 19.0 < state.answer(0)["left"] <= 20.5
    state.take("point", {"velocity": 1.0, "torque": 0.3, "verdict": "short", "reason": "too short"})
    assert state.answer(0)["points"][0]["reason"] == "too short"
    assert not math.isnan(state.answer(0)["done"])


def open_browser(tmp_path: Path, address: str) -> str:
    """The page as a browser without a screen has it after three seconds."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("no browser to open the page in: apt-get install chromium")
    apart = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}"]
    call = [browser, *apart, "--virtual-time-budget=3000", "--dump-dom", address]
    return subprocess.run(call, check=True, capture_output=True, timeout=120).stdout.decode()


def test_a_browser_shows_what_the_joint_does(feed: LiveFeed, tmp_path: Path) -> None:
    with open_adapter("sim", {"backend": "sim"}) as adapter:
        feed.attach(adapter)
        make_loop(adapter).run(0.3)
        shown = open_browser(tmp_path, feed.address)
    assert '<h1 id="title">Elbow</h1>' in shown
    assert re.search(r'id="n-position">-?[0-9.e-]+ rad<', shown)
    assert re.search(r'id="n-torque">-?[0-9.e-]+ N·m', shown)
    assert not feed.stopped.is_set()


def test_the_button_in_a_browser_stops_the_joint_in_mid_motion(tmp_path: Path) -> None:
    def click(feed: LiveFeed) -> None:
        page = (
            ask(feed, urlsplit(feed.address).path)[1].decode().replace("<head>", f'<head><base href="{feed.address}">')
        )
        clicked = tmp_path / "clicked.html"
        clicked.write_text(page.replace("</body>", "<script>document.getElementById('stop').click()</script></body>"))
        open_browser(tmp_path, clicked.as_uri())

    with LiveFeed("Elbow") as feed:
        require_prompt(*press_in_motion("sim", feed, click))
