"""The workbench: a log in, a map out, every run kept."""

from ._workbench import Workbench

__all__ = ["Workbench"]
