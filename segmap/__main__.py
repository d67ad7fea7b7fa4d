"""`python -m segmap`, and the command `segmap`: `segmap --help` lists what there is."""

from __future__ import annotations

import sys

from ._commands import main

if __name__ == "__main__":
    sys.exit(main())
