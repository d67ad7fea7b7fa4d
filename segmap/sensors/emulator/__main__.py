"""Start an emulated sensor and print the device or address to open, until Control-C."""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys
import threading

from ...files import shown, speak
from .. import SensorError
from . import Emulator


def main(arguments: list[str] | None = None) -> int:
    """Run it and return its exit code: 0, or 1 after a line that says what went wrong."""
    speak()
    options = _emulator_parser().parse_args(arguments)
    try:
        _run(options)
    except (SensorError, OSError, ValueError) as error:
        print(shown(f"{type(error).__name__}: {error}"), file=sys.stderr)
        return 1
    return 0


def _run(options: argparse.Namespace) -> None:
    stopping = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stopping.set())
    protocol = "1.1" if options.model == "URG-04LX" else "2.0"  # as they come from the factory
    with Emulator(
        model=options.model, tcp=options.tcp, speed=options.speed, protocol=protocol
    ) as emulator:
        print(emulator.port, flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            stopping.wait()


def _emulator_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m segmap.sensors.emulator", description=__doc__)
    parser.add_argument("--model", choices=("URG-04LX", "UST-10LX"), default="URG-04LX")
    parser.add_argument(
        "--tcp",
        metavar="[HOST:]PORT",
        help="to be reached by TCP, one program at a time; port 0 takes a free one",
    )
    parser.add_argument("--speed", type=float, default=1.0, help="times real time (default 1)")
    return parser


if __name__ == "__main__":
    sys.exit(main())
