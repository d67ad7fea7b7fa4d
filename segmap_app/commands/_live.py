"""`segmap live MODEL PORT`: a log and a map of a laser that is carried through the building."""

from __future__ import annotations

import signal
import time
from pathlib import Path
from typing import Annotated, NoReturn

from segmap.files import escape
from segmap.progress import told
from segmap.sensors import SensorError, ports, spinning_models

from ..drives import HOKUYO, Driving, drive, new_path
from . import _map
from ._output import Usage, print_error, reason
from .log_options import File, command

#: Seconds from one line to the next.
LINE_S = 1.0


@command(
    "live",
    "live                               lists serial ports and models",
    "live LD19 /dev/ttyUSB0 -o it.svg   until Control-C; then it is mapped",
    "live hokuyo --log drive.csv        the one Hokuyo on USB",
)
def live(
    model: str | None = None,
    port: str | None = None,
    /,
    *,
    log: File[Path | None] = None,
    counter_clockwise: bool = False,
    output: Annotated[tuple[str, ...], _map.OUTPUT] = (),
) -> int:
    """A log and a map of a laser that you carry: RPLidar, LD19, YDLidar, Hokuyo.

    It is recorded until Control-C or until the laser falls silent, and then mapped as `segmap map`
    does.

    Parameters
    ----------
    model
        Of the laser, or hokuyo.
    port
        Device, as /dev/ttyUSB0.
    log
        The log, .csv; default: live-DATE-TIME.csv.
    counter_clockwise
        The angles grow counter-clockwise, seen from above; default: as the maker says.
    """
    if model is None or not (port or model.upper() == HOKUYO):
        return tell_what_there_is()
    path = log or new_path()
    if path.suffix.lower() != ".csv" or path.exists():
        raise Usage(f"--log {escape(path)} must be a new file whose name ends in .csv")
    stop_on_signals()
    begun = line = time.monotonic()

    def say(share: float, words: str) -> None:
        """What is assumed, and each second how far it is."""
        nonlocal line
        if isinstance(words, Driving) and (share == 0 or time.monotonic() - line >= LINE_S):
            line = time.monotonic()
            print(escape(words), flush=True)

    with told(say):
        why = drive(model, port or "", path, False if counter_clockwise else None)
    if why:
        print_error(why)
    if not path.exists():
        return 1
    print(f"{escape(path)}: {time.monotonic() - begun:.0f} s")
    from ._main import main

    outputs = [word for name in output for word in ("-o", name)]
    return main(["map", str(path), *outputs]) or int(bool(why))


def stop_on_signals() -> None:
    """Leave with the laser off on Control-C, on `kill`, and when the terminal is closed.

    Who starts the program with nohup wants it to outlive the terminal, so that stays.
    """
    numbers = [signal.SIGINT, signal.SIGTERM]
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        numbers.append(signal.SIGHUP)

    def interrupt(number: int, frame: object) -> NoReturn:
        for number in numbers:  # a second signal must not keep the laser from being switched off
            signal.signal(number, signal.SIG_IGN)
        raise KeyboardInterrupt

    for number in numbers:
        signal.signal(number, interrupt)


def tell_what_there_is() -> int:
    """Serial ports and models, a line each; what was not said is missing, so it is no success."""
    try:
        lines = [f"{port.device}  {port.description}" for port in ports()]
        for line in lines or ["no serial port: is the laser plugged in?"]:
            print(escape(line))
        print(f"models: {HOKUYO.lower()}, {', '.join(spinning_models())}")
    except SensorError as error:  # a package is missing
        print_error(reason(error))
    print_error("name a model and a port: segmap live LD19 /dev/ttyUSB0 -o map.svg")
    return 2
