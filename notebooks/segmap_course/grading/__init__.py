"""Grading: students' answers run behind locks, and what comes out is judged here."""

from ._grade import grade, plan_of, read_key
from ._jail import Limits
from ._report import class_report
