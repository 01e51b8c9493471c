"""The process that serves the page: it reads the ring and the messages, and hands one word back, `stop`."""

import contextlib
import json
import math
import os
import signal
import threading
import time
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from multiprocessing.connection import Connection
from secrets import compare_digest
from typing import Any
from urllib.parse import parse_qs, urlsplit

from .curve import LiveCurve
from .ring import CycleRing

_MOST_ROWS = 240
"""Rows of one answer; a page that asks five times a second draws more than a thousand a second then."""
_NICE = 10
"""By how much the page gives way to the loop on a crowded processor."""
_FAREWELL = 1.5
"""Time for which the last state can still be fetched [s]."""


class LiveState:
    """What the page shows, as the messages have made it.

    Args:
        title: Heading of the page.
    """

    def __init__(self, title: str) -> None:
        self._lock = threading.Lock()
        self._content: dict[str, Any] = {"title": title, "joints": [], "points": [], "text": "starting", "done": 0.0}
        self._began, self._phase = time.monotonic(), ""
        self._ring: CycleRing | None = None
        self._curve = LiveCurve()
        self.fetched_end = threading.Event()

    def take(self, kind: str, content: dict[str, Any]) -> None:
        """Take a message of the loop's side."""
        with self._lock:
            if kind == "joints":
                if self._ring is not None:
                    self._ring.close()
                self._ring = CycleRing(len(content["joints"]), content["ring"])
                self._content |= content | {"points": [], "curve": None}
                self._curve.forget()
            elif kind == "progress":
                phase = str(content["text"]).partition(":")[0]
                if phase != self._phase:
                    self._began, self._phase = time.monotonic(), phase
                self._content |= {"duration": None} | content
            elif kind == "point":
                self._content["points"].append(content)
                self._curve.add(content)
            elif kind == "end":
                self._content["end"] = content

    def note_stop(self) -> None:
        """Show that stop was pressed."""
        with self._lock:
            self._content["stopping"] = True

    def answer(self, since: int) -> dict[str, Any]:
        """Everything, with the rows that came after the first `since`."""
        with self._lock:
            told = dict(self._content) | {"curve": self._curve.newest, "left": self._time_left()}
            count, rows = self._ring.read(since, _MOST_ROWS) if self._ring is not None else (0, [])
        told |= {"count": count, "rows": rows}
        if "end" in told:
            self.fetched_end.set()
        return told

    def _time_left(self) -> float | None:
        """Of what is being done [s]; None where nothing is known of it."""
        elapsed, done = time.monotonic() - self._began, float(self._content["done"])
        duration = self._content.get("duration")
        if duration is not None:
            return float(max(duration - elapsed, 0.0))
        return elapsed * (1.0 - done) / done if done > 0.0 else None


def serve(pipe: Connection, token: str, title: str) -> None:
    """Serve until the other side of the pipe says that it is over, or is gone.

    Args:
        pipe: Gives messages; takes the port first, and `stop`.
        token: First part of every path; whoever does not know it gets nothing.
        title: Heading of the page.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the loop's, which tells the page
    with contextlib.suppress(OSError, AttributeError):
        os.nice(_NICE)
    state = LiveState(title)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, state, pipe, token))
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    pipe.send(server.server_address[1])
    with contextlib.suppress(EOFError, OSError):
        while (message := pipe.recv()) is not None:
            state.take(*message)
    state.fetched_end.wait(_FAREWELL)
    server.shutdown()


class _Handler(BaseHTTPRequestHandler):
    """GET TOKEN/ is the page, GET TOKEN/state what it shows, POST TOKEN/stop the one thing that it can do."""

    server_version, sys_version = "fricomp", ""

    def __init__(self, state: LiveState, pipe: Connection, token: str, *arguments: Any) -> None:
        self._state, self._pipe, self._token = state, pipe, token
        super().__init__(*arguments)

    def do_GET(self) -> None:
        asked = urlsplit(self.path)
        if self._refuse(asked.path):
            return
        if asked.path.endswith("/state"):
            since = parse_qs(asked.query).get("since", ["0"])[0]
            told = self._state.answer(int(since) if since.isdigit() else 0)
            self._send(json.dumps(_finite(told)).encode(), "application/json")
        else:
            self._send(files("fricomp.live").joinpath("page.html").read_bytes(), "text/html; charset=utf-8")

    def do_POST(self) -> None:
        if self._refuse(self.path) or not self.path.endswith("/stop"):
            return
        self._pipe.send("stop")
        self._state.note_stop()
        self._send(b"{}", "application/json")

    def _refuse(self, path: str) -> bool:
        """Answer 404 to whoever does not know the token, and to a name that is not this machine's."""
        host = (self.headers.get("Host") or "").rpartition(":")[0]
        given, _, rest = path.lstrip("/").partition("/")
        known = rest in (("stop",) if self.command == "POST" else ("", "state"))
        if host in ("127.0.0.1", "localhost") and compare_digest(given.encode(), self._token.encode()) and known:
            return False
        self.send_error(HTTPStatus.NOT_FOUND)
        return True

    def _send(self, content: bytes, kind: str) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", "default-src 'self' 'unsafe-inline'; frame-ancestors 'none'")
        self.end_headers()
        with contextlib.suppress(OSError):  # the browser has gone on
            self.wfile.write(content)

    def log_message(self, format: str, *arguments: Any) -> None:
        """Say nothing: the terminal is the command's."""


def _finite(value: Any) -> Any:
    """The value with None in place of numbers that JSON does not have."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return value
