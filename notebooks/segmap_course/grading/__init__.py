"""Grading: students' answers run in a jail, and what comes out is judged here."""

from ._grade import graded, plan_of, read_key
from ._jail import Limits
from ._report import Table, class_report, duplicates, gradescope, write_feedback

__all__ = [
    "Limits", "Table", "class_report", "duplicates", "graded", "gradescope", "plan_of", "read_key",
    "write_feedback",
]  # fmt: skip
