"""`fricomp bench mismatch`: what the diagnosis names in joints whose truth is concealed from it."""

from fricomp.cli.lazy import lazy_app

_COMMANDS = {
    "run": "Conceal physics in joints, diagnose them blind, and score the answers.",
    "page": "Write the page of a run without running anything.",
    "gap": "How much of the held-out error a diagnosis closes.",
    "replay": "Diagnose the cases of a kept run anew.",
    "compare": "The answers of two runs of the same cases side by side.",
    "speed-up": "How much faster two workers diagnose than one.",
}

_EPILOG = """fricomp bench mismatch run --quick --out runs/mismatch

fricomp bench mismatch page --out runs/mismatch --page docs/proof.md"""

app = lazy_app(
    "fricomp.cli.bench.mismatch",
    _COMMANDS,
    default="run",
    help="Joints with physics that their simulation leaves out, diagnosed blind.",
    epilog=_EPILOG,
    add_completion=False,
)
