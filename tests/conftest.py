"""What holds for every test: property tests draw the same examples, and store none; one thread of linear algebra a
process; one browser; white charts where their looks are not the matter; files without slow tests are not loaded for
the slow part."""

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from hypothesis import settings

for _threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(
        _threads, "1"
    )  # numpy is not loaded yet; two workers with two threads each wait for each other

settings.register_profile("repeatable", derandomize=True, database=None, deadline=None)
settings.load_profile("repeatable")

_QUIET = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--proxy-server=127.0.0.1:9",  # nothing answers there
)  # fmt: skip
_OWN_ACCORD = "not an origin"  # who asks, in the network log, for what no page has asked for


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """A file that does not speak of slow tests has none."""
    is_tests = config.getoption("markexpr") == "slow" and collection_path.name.startswith("test_")
    return True if is_tests and "slow" not in collection_path.read_text(encoding="utf-8") else None


class OpenedPage(NamedTuple):
    """What a browser made of a page.

    Attributes:
        dom: The document after its scripts have run.
        complaints: Lines on its console, such as script errors.
        fetched: Addresses that the page asked a network for.
    """

    dom: str
    complaints: tuple[str, ...]
    fetched: tuple[str, ...]


@pytest.fixture
def open_page(tmp_path: Path) -> Callable[[Path], OpenedPage]:
    """Opens a file in a real browser without a network; skips the test where no browser is installed."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("no browser to open the page in: apt-get install chromium")

    def opened(page: Path) -> OpenedPage:
        log = tmp_path / "network.json"
        options = ["--virtual-time-budget=8000", "--dump-dom", "--enable-logging=stderr", "--v=0"]
        apart = [f"--user-data-dir={tmp_path / 'profile'}", f"--log-net-log={log}", page.as_uri()]
        shown = subprocess.run([browser, *_QUIET, *options, *apart], check=True, capture_output=True, timeout=180)
        said = tuple(line for line in shown.stderr.decode(errors="replace").splitlines() if ":CONSOLE:" in line)
        return OpenedPage(shown.stdout.decode(), said, _fetched(json.loads(log.read_text())))

    return opened


@pytest.fixture(scope="session", autouse=True)
def white_charts() -> Iterator[Callable[[Any], Any]]:
    """Charts are put together and left white: a fifth of what a command takes goes into pictures. Gives what draws."""
    from fricomp.report import png

    draw = png._render
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(png, "_render", _leave_white)
        yield draw


@pytest.fixture(scope="module")
def drawn_charts(white_charts: Callable[[Any], Any]) -> Iterator[None]:
    """From here to the end of the module charts are drawn."""
    from fricomp.report import png

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(png, "_render", white_charts)
        yield


def _leave_white(figure: Any) -> Any:
    from PIL import Image

    return Image.new("RGB", (1, 1), "white")


def _fetched(log: dict[str, Any]) -> tuple[str, ...]:
    """Addresses in a browser's network log that a page asked for."""
    start = log["constants"]["logEventTypes"]["URL_REQUEST_START_JOB"]
    asked = [event["params"] for event in log["events"] if event["type"] == start and "url" in event.get("params", {})]
    local = ("file:", "data:", "blob:", "chrome")
    return tuple(
        one["url"] for one in asked if one.get("initiator") != _OWN_ACCORD and not one["url"].startswith(local)
    )
