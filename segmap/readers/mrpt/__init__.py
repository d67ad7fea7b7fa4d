"""Logs and maps of MRPT."""

from .._text import Binary
from . import _mrpt

MRPT = Binary("MRPT", _mrpt.claims, _mrpt.read)
