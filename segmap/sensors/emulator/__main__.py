"""Start an emulated sensor and print the device or address to open, until Control-C."""

from __future__ import annotations

import argparse
import contextlib
import gzip
import signal
import sys
import threading
from pathlib import Path

from ...files import shown, speak
from .. import SensorError
from . import Emulator, Replay


def main(arguments: list[str] | None = None) -> int:
    """Run it and return its exit code: 0, or 1 after a line that says what went wrong."""
    speak()
    given = _emulator_parser().parse_args(arguments)
    try:
        _run(given)
    except (SensorError, OSError, ValueError) as error:
        print(shown(f"{type(error).__name__}: {error}"), file=sys.stderr)
        return 1
    return 0


def _run(given: argparse.Namespace) -> None:
    stopping = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stopping.set())
    world = None if given.replay is None else Replay(_bytes(given.replay), model=given.model)
    settings = {name: getattr(given, name) for name in ("model", "tcp", "rate", "speed", "link")}
    settings["protocol"] = given.protocol or ("1.1" if given.model == "URG-04LX" else "2.0")
    with Emulator(world, usb=not given.serial, **settings) as emulator:
        print(emulator.port, flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            stopping.wait()


def _bytes(path: Path) -> bytes:
    with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
        return file.read()


def _emulator_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m segmap.sensors.emulator", description=__doc__)
    parser.add_argument("--model", choices=("URG-04LX", "UST-10LX"), default="URG-04LX")
    parser.add_argument(
        "--tcp",
        metavar="[HOST:]PORT",
        help="to be reached by TCP, one program at a time; port 0 takes a free one",
    )
    parser.add_argument("--protocol", choices=("2.0", "1.1", "1.1 only"), help="after power-up")
    parser.add_argument("--rate", type=int, default=19200, help="bits a second (default 19200)")
    parser.add_argument("--serial", action="store_true", help="as on RS-232: the rate matters")
    parser.add_argument("--speed", type=float, default=1.0, help="times real time (default 1)")
    parser.add_argument("--replay", type=Path, help="a capture of a sensor's bytes, .gz or plain")
    parser.add_argument("--link", type=Path, help="a symbolic link to make to the device")
    return parser


if __name__ == "__main__":
    sys.exit(main())
