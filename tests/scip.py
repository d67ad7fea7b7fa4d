"""Replies of a sensor, written and read by the manual of SCIP: what the driver is held against."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

from segmap.sensors import checksum
from segmap.sensors.emulator import Unit


class Reply(NamedTuple):
    """A reply: the echoed request, its status, and the lines after it."""

    echo: str
    status: str
    body: tuple[bytes, ...] = ()


def reply(echo: str, status: str, body: Iterable[bytes] = ()) -> bytes:
    """A whole reply, its empty line included."""
    told = status.encode()
    return b"\n".join([echo.encode(), told + checksum(told), *body, b"", b""])


def replies(said: bytes) -> list[Reply]:
    """Replies in what a sensor said, their sums of the status seen to."""
    found = []
    for text in filter(None, said.strip(b"\n").split(b"\n\n")):
        echo, status, *body = text.split(b"\n")
        assert status[2:] == checksum(status[:2])
        found.append(Reply(echo.decode(), status[:2].decode(), tuple(body)))
    return found


def answer_instead(unit: Unit, command: str, answer: Callable[[str], bytes | None]) -> None:
    """Let a unit answer a command by other bytes, where `answer(text)` gives some."""
    receive, transmit, said = unit.receive, unit.transmit, list[bytes]()

    def received(data: bytes) -> None:
        text = data.decode("latin-1").strip()
        other = answer(text) if text.startswith(command) else None
        if other is None:
            receive(data)
        else:
            said.append(other)

    def transmitted() -> bytes:
        found, said[:] = b"".join(said), []
        return found + transmit()

    unit.receive, unit.transmit = received, transmitted  # type: ignore[method-assign]
