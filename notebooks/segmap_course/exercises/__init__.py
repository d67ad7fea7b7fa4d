"""Exercises: a student's function beside the library's; each known mistake has a hint.

Each file holds those of one subject: their cases, wrong answers and hints; the course lists them.
"""

from .._alone import NOT_GIVEN, Raised, decode, encode
from ._exercise import Check, Exercise
from ._notice import Watch, plain

__all__ = ["NOT_GIVEN", "Check", "Exercise", "Raised", "Watch", "decode", "encode", "plain"]
