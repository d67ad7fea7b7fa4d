"""From a terminal: find a sensor, ask what it is, record what it sees."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from typing import NoReturn

from ..files import shown, speak
from . import SensorError, UrgSensor, record
from ._port import ports
from ._record import check_target

_PORT = "device, or tcp://host[:10940] on Ethernet (default: the Hokuyo on USB)"


def main(arguments: list[str] | None = None, *, prog: str = "python -m segmap.sensors") -> int:
    """Run a command and return its exit code: 0, or 1 after a line that says what went wrong."""
    speak()
    options = _parser(prog).parse_args(arguments)
    try:
        options.run(options)
    except KeyboardInterrupt:
        return 130
    except (SensorError, OSError, ValueError) as error:
        print(shown(f"{type(error).__name__}: {error}"), file=sys.stderr)
        return 1
    return 0


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


def _list(options: argparse.Namespace) -> None:
    available = ports()
    for port in available:
        kind = "Hokuyo" if port.is_hokuyo else "other "
        print(shown(f"{port.device}  {kind}  {port.description}"))
    if not available:
        print("no serial port: is the sensor plugged in?")


def _info(options: argparse.Namespace) -> None:
    with UrgSensor(options.port) as sensor:
        for key, text in (sensor.info | sensor.state()).items():
            print(shown(f"{key}  {text}"))
        print(f"RATE  {sensor.rate} bit/s")
        print(f"SCAN  {sensor.scan()}")


def _record(options: argparse.Namespace) -> None:
    check_target(options.path, options.count)  # before the sensor is asked for anything
    with UrgSensor(options.port, reconnect=options.reconnect) as sensor:
        try:
            record(sensor, options.path, count=options.count)
        except KeyboardInterrupt:
            pass
        finally:
            print(f"{sensor.delivered} scans, {sensor.dropped} dropped; {shown(options.path)}")
            if sensor.slow:
                print(sensor.slow)


def _parser(prog: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=prog, description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="list | info | record")
    command = commands.add_parser("list", help="serial ports, Hokuyo's first")
    command.set_defaults(run=_list)
    command = commands.add_parser("info", help="who the sensor is, how it is, and one scan")
    command.set_defaults(run=_info)
    _add_port(command)
    command = commands.add_parser("record", help="scans to a log, until Control-C")
    command.set_defaults(run=_record)
    command.add_argument("path", type=Path, help="for CARMEN, x.log; scans are added")
    _add_port(command)
    command.add_argument("--count", type=int, help="stop after so many scans")
    command.add_argument(
        "--reconnect", type=float, default=0.0, help="seconds to wait for an unplugged sensor"
    )
    return parser


def _add_port(command: argparse.ArgumentParser) -> None:
    command.add_argument("--port", default="auto", help=_PORT)


if __name__ == "__main__":
    stop_on_signals()
    sys.exit(main())
