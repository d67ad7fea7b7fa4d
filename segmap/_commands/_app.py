"""`segmap app`: the workbench as a page of its own in the browser."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser("app", help="open the workbench in the browser: no code needed")
    command.add_argument("--port", type=int, metavar="N", help="default: one that is free")
    command.add_argument(
        "--no-browser", action="store_true", help="print the address only, as without a display"
    )
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> None:
    """Serve the page until Control-C; who has the address with its token sees it, nobody else."""
    try:
        from voila.app import Voila
    except ImportError as error:
        raise ImportError("the page needs voila: pip install 'segmap[app]'") from error
    page = Path(__file__).parents[1] / "panels" / "workbench" / "app.ipynb"
    options = [str(page), "--Voila.ip=127.0.0.1", "--Voila.auto_token=True"]
    if given.port is not None:
        options += [f"--Voila.port={given.port}", "--Voila.port_retries=0"]
    shown = sys.platform in ("darwin", "win32") or {"DISPLAY", "WAYLAND_DISPLAY"} & {*os.environ}
    Voila.launch_instance([*options, *["--no-browser"] * (given.no_browser or not shown)])
