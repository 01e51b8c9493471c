"""`fricomp bench arms`: what is named in arms whose truth is concealed, and how well their links are known."""

from fricomp.cli.lazy import lazy_app

_COMMANDS = {
    "run": "Conceal links and physics in arms, examine them blind, and score the answers.",
    "page": "Write the page of a run without running anything.",
}

_EPILOG = """fricomp bench arms run --cases 10 --out runs/arms

fricomp bench arms page --out runs/arms --page docs/arms-proof.md"""

app = lazy_app(
    "fricomp.cli.bench.arms",
    _COMMANDS,
    default="run",
    help="Arms with wrong links and physics that their simulation leaves out, examined blind.",
    epilog=_EPILOG,
    add_completion=False,
)
