"""How many bytes a packed file may unpack to: one bound for whatever packs, chunks of bags too."""

from __future__ import annotations

import bz2
import importlib
from pathlib import Path
from typing import Any

from ...files import most_unpacked
from ..lines import LogError


class Budget:
    """The bytes that some files may still unpack to; `path` is what the error names."""

    def __init__(self, path: Path, packed_bytes: int) -> None:
        self.path = path
        self.most = self.rest = most_unpacked(packed_bytes)

    def take(self, count: int) -> None:
        """Use so many bytes up; where they are not left, that is a LogError."""
        self.rest -= count
        if self.rest < 0:
            reason = f"unpacks to more than {self.most} bytes: unpack it, if it is a log"
            raise LogError(self.path, reason)

    def unpacked(self, packing: str, data: bytes) -> bytes:
        """Unpack bytes by bz2, lz4 or zstd, as far as the budget goes."""
        parts = []
        while data:  # of zstd several frames may follow each other
            unpacker = _unpacker(packing)
            parts.append(unpacker.decompress(data, self.rest + 1))
            self.take(len(parts[-1]))
            data = unpacker.unused_data
        return b"".join(parts)


def _unpacker(packing: str) -> Any:
    """What unpacks piece by piece; `rosbags` brings the packages of the last two."""
    if packing == "bz2":
        return bz2.BZ2Decompressor()
    if packing == "lz4":
        return importlib.import_module("lz4.frame").LZ4FrameDecompressor()
    return importlib.import_module("rosbags.rosbag2.reader").zstd.ZstdDecompressor()
