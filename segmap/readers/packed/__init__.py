"""Packed files and encodings, understood once: readers get plain files."""

from ._budget import Budget
from ._plain import log_file, read_text

__all__ = ["Budget", "log_file", "read_text"]
