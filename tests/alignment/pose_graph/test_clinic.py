"""The building of the story: the pose graph finds the way in it, whatever the seed."""

import numpy as np
import pytest

from segmap import alignment, load
from segmap.readers import data_file, read_segments
from segmap.simulation import CHEAP_WHEELS, URG_04LX, simulate

LOG = load("clinic")


def worst(log, poses):
    """Largest distance of a pose from the true one, metres."""
    return np.hypot(*(poses - log.truth)[:, :2].T).max()


def test_the_pose_graph_is_among_the_best_alignments_of_the_clinic():
    """Catches false loops between rooms that look alike, and a ring that stays open."""
    others = [
        m for name, m in alignment.METHODS.items() if name not in ("ground_truth", "pose_graph")
    ]
    best = min(worst(LOG, method(LOG).poses) for method in others)
    assert worst(LOG, LOG.odometry) > 2
    assert worst(LOG, alignment.pose_graph(LOG).poses) < min(0.05, best + 0.01)


@pytest.mark.parametrize("seed", [1, 7])
def test_another_drive_through_the_clinic_is_placed_as_well(seed):
    """Catches a building whose one seed was chosen because it succeeds."""
    walls, rng = read_segments(data_file("clinic/walls.csv")), np.random.default_rng(seed)
    log = simulate(walls, LOG.truth, sensor=URG_04LX, odometry_noise=CHEAP_WHEELS, rng=rng)
    assert worst(log, log.odometry) > 1 and worst(log, alignment.pose_graph(log).poses) < 0.05
