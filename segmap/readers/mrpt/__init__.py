"""Logs and maps of MRPT."""

from .._text import Binary
from . import _mrpt

__all__ = ["MRPT"]

MRPT = Binary("MRPT", _mrpt.claims, _mrpt.read)
