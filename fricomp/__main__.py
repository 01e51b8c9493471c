"""`fricomp`, and `python -m fricomp` where its script is not on the path: the command line."""

import sys


def run() -> None:
    """Entry point of `fricomp`; Ctrl-C while its packages are still being imported is one sentence too."""
    try:
        from .cli.main import run as run_command

        run_command()
    except KeyboardInterrupt:
        sys.stderr.write("\nInterrupted.\n")
        sys.exit(130)


if __name__ == "__main__":
    run()
