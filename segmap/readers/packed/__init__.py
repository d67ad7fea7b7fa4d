"""Packed files and encodings, understood once: readers get plain files."""

from ._plain import log_file, read_text

__all__ = ["log_file", "read_text"]
