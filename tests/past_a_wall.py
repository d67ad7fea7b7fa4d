"""Drives past a wall of 10 cm between two rooms: other lasers, three buildings."""

from dataclasses import replace

import numpy as np
from segmap_course import clinic_walls

import segmap
from segmap import simulation

STOPS = [(0.7, 5), (11.3, 5), (10, 5), (10, 7.4), (10, 2.6), (10, 5), (6, 5), (6, 7.4)]
#: Standard deviation of a range, metres, and the share of the range that it grows by.
NOISE = [(0.005, 0), (0.01, 0), (0.02, 0), (0.03, 0), (0.005, 0.006)]


def drive_past_a_wall(building, noise, seed):
    """A log on cheap wheels in a building, and the middle of a wall of 10 cm in it, x and y."""
    if building == "clinic":
        walls, path, middle = clinic_walls(), segmap.load("clinic").truth, (5.45, 2.4)
    else:
        walls = simulation.office(rng=np.random.default_rng(building))
        path, middle = simulation.drive(STOPS, step=0.4), (8.0, 6.8)
    sensor = replace(simulation.URG_04LX, sigma=noise[0], range_share=noise[1])
    wheels, rng = simulation.CHEAP_WHEELS, np.random.default_rng(seed)
    return simulation.simulate(walls, path, sensor=sensor, odometry_noise=wheels, rng=rng), middle


def thickness(segments, middle, away=0.9):
    """Of the wall between two rooms, from nine beams to each face, metres."""
    x, ahead = middle[0] - away, 2 * away
    reach = [
        sum(
            simulation.cast_rays(segments, pose, [0.0])[0]
            for pose in ((x, y, 0.0), (x + ahead, y, np.pi))
        )
        for y in middle[1] + np.linspace(-0.2, 0.2, 9)
    ]
    return ahead - np.median(reach)
