"""A bus on which answers take their time, as on every real one: twins in memory answer before a request returns."""

from __future__ import annotations

from typing import Any

from fricomp.sim_bench.studies.adapters.bench import AdapterBench, make_bench

LATENCY_NS = 300_000


class LateLink:
    """Hands on what has come no sooner than `LATENCY_NS` after it was sent."""

    def __init__(self, link: Any, bench: AdapterBench) -> None:
        self._link, self._clock = link, bench.clock
        self._underway: list[tuple[int, Any]] = []
        self._nothing = link.receive()

    def send(self, content: Any) -> None:
        self._link.send(content)
        self._collect()

    def _collect(self) -> None:
        answer = self._link.receive()
        if answer:
            self._underway.append((self._clock.now_ns() + LATENCY_NS, answer))

    def receive(self) -> Any:
        self._collect()
        come, now = self._nothing, self._clock.now_ns()
        while self._underway and self._underway[0][0] <= now:
            come = come + self._underway.pop(0)[1]
        return come

    def discard_output(self) -> None:
        self._link.discard_output()

    def close(self) -> None:
        self._link.close()


def make_late_bench(protocol: str, n_joints: int = 1) -> AdapterBench:
    """A bench whose answers are late."""
    bench = make_bench(protocol, n_joints)
    link: Any = LateLink(bench.link, bench)
    bench.adapter._open_link = lambda: link  # type: ignore[attr-defined]
    return bench
