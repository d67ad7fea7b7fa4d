"""The exam bank: forty questions, five a goal of the syllabus; numbers of its answers are true."""

import re

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import ROOT
from scipy.stats import chi2
from segmap_course.literal import occupancy

from segmap.poses import compose, transform

TEXT = (ROOT / "notebooks/EXAM.md").read_text(encoding="utf-8")
PARTS = re.findall(r"^## Goal (\d): ", TEXT, re.MULTILINE)
#: Number of the part and of the question, points, all that follows.
QUESTIONS = re.findall(
    r"^\*\*(\d)\.(\d)\*\* \((\d) points\) (.*?)(?=^\*\*\d|^## |\Z)", TEXT, re.MULTILINE | re.DOTALL
)


def answer(number):
    part, question = number.split(".")
    return next(text for p, q, _, text in QUESTIONS if (p, q) == (part, question))


def right(name, *given):
    return course.EXERCISES[name].solution(*given)


def test_numbers_of_the_answers_are_those_of_the_library():
    """Catches a model answer that a student may rightly contest."""
    assert "11 mm" in answer("0.1") and round(50 * np.log(1 / 0.8)) == 11
    assert "(1, 5)" in answer("1.1")
    assert transform((1, 2, np.pi / 2), [(3, 0)])[0].round(9).tolist() == [1, 5]
    assert compose((2, 0, np.pi / 2), (1, 0, 0)).round(6)[:2].tolist() == [2, 1]
    for share, count in ((0.2, 113), (0.1, 459)):
        assert right("ransac_trials", share, 0.99) == count and f"N = {count}" in answer("2.4")
    nees = right("nees", np.array([[0.005, 0, 0]]), np.zeros((1, 3)), np.eye(3)[None] * 0.0005**2)
    assert nees[0] == pytest.approx(100) and chi2.ppf(0.99, 3).round(1) == 11.3
    assert "0 (or 180)" in answer("5.1")
    assert right("axial_mean", np.radians([1, 179])) % np.pi % np.pi == pytest.approx(0, abs=1e-9)
    assert right("cell_of", -0.5, 0.0, 1.0) == -1 and "floor: -1" in answer("6.1")
    assert occupancy(20, 0, 20) == 0 and occupancy(21, 1, 20) == 1 / 21
    assert (100 - 16_777_200) % 2**24 == 116 and "116 ms" in answer("7.4")
    assert 0 * 4096 + 3 * 64 + 1 == 193 and "193 mm" in answer("7.1")
    assert round(2134 * 10 / 115200, 3) == 0.185 and "0.185 s" in answer("7.2")
