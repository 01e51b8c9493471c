"""The page `docs/identification.md`: measured figures from the store between what they mean."""

import os
import platform
from collections.abc import Sequence
from importlib.metadata import version

from fricomp.report import Chart

from ..kit.page import fill_template
from ..kit.store import RowStore
from . import sections
from .printed import NOISE_FREE, NOISY
from .problem import NOISE_READINGS
from .rivals import FULL_SIZES


def format_identification_page(ledger: RowStore, charts: Sequence[Chart], command: str, folder: str) -> str:
    """The whole page as Markdown.

    Args:
        ledger: Finished draws.
        charts: Drawn into `folder` under their names.
        command: What wrote the page.
        folder: Where its pictures lie, seen from the page.
    """

    def pictures(*beginnings: str) -> str:
        found = [chart for chart in charts if chart.name.startswith(beginnings)]
        return "\n".join(f"![{chart.title}]({folder}/{chart.name}.png)\n" for chart in found)

    return fill_template(
        "paper/page.md",
        command=command,
        machine=_describe_machine(),
        pictures=pictures,
        readings=NOISE_READINGS,
        full_draws=FULL_SIZES.full,
        short_draws=FULL_SIZES.tenth,
        targets=sections.format_target_table(ledger),
        printed_noise_free=sections.format_printed_table(NOISE_FREE, ledger, ["none"]),
        noise_free=sections.format_noise_free_section(ledger),
        printed_noisy=sections.format_printed_table(NOISY, ledger, NOISE_READINGS),
        statistics=[sections.format_statistics_section(ledger, reading) for reading in NOISE_READINGS],
        searches=sections.format_search_section(ledger),
        times=sections.format_timing_section(ledger),
        outliers=sections.format_outlier_section(ledger),
        departure=sections.format_departure_section(ledger),
        loads=sections.format_load_section(ledger),
        extras=sections.format_extras_section(ledger),
    )


def _describe_machine() -> str:
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "torch"))
    return f"{os.cpu_count()} cores, {platform.machine()}, Python {platform.python_version()}, {packages}"
