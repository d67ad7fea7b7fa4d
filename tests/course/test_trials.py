"""Trials of matchers: what they measure, and the records that come with segmap."""

from dataclasses import replace

import numpy as np
import pytest
from segmap_course import load_trials, room_walk, try_pair

from segmap import Log


def test_a_record_is_made_again():
    """Same walk, same seed, same errors; the machine may be another."""
    drawn = [t for t in load_trials() if (t.matcher, t.score) == ("sample and rank", "field")]
    record = drawn[0]
    again = try_pair(room_walk(seed=record.seed), "sample and rank", "field", seed=record.seed)
    assert replace(again, seconds=0.0) == replace(record, seconds=0.0)


def test_a_trial_measures_from_the_truth():
    """A log whose truth is shifted after the first pose: every error is that shift."""
    log = room_walk()[:4]
    truth = log.truth + np.array([[0, 0, 0]] + [[0.3, 0.4, 0]] * 3)
    trial = try_pair(Log("moved", log.scans, truth), "hill climbing", "field")
    assert trial.median == pytest.approx(0.5, abs=0.05)
