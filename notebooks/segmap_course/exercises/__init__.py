"""Exercises: a student's function beside the library's; each known mistake has a hint.

Each file holds those of one subject: their cases, wrong answers and hints; the course lists them.
"""

from ._exercise import Check, Exercise

__all__ = ["Check", "Exercise"]
