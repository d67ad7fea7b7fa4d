"""`python -m segmap`, and the command `segmap`: `segmap --help` lists what there is."""

from __future__ import annotations

import sys


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code, as where it is stopped while it is being loaded."""
    try:
        from segmap_app.commands import main as command
    except KeyboardInterrupt:
        print("segmap: stopped", file=sys.stderr)
        return 130
    return command(arguments)


if __name__ == "__main__":
    sys.exit(main())
