"""Chapter 28: the plain steps from walls to rooms, the library's plan, and what is said of both."""

from dataclasses import replace

import numpy as np
import pytest
from plan_buildings import log_of, two_rooms
from segmap_course import clinic_walls
from segmap_course.literal.floor_plan import (
    axis_of,
    cells_of,
    join_narrow,
    join_open,
    offsets_of,
)

import segmap
from segmap import plan, quadtree, reduction, simulation
from segmap.alignment import pose_graph
from segmap.poses import compose, transform

SIDE = 0.05
#: Area of the six rooms of the clinic, furniture included, square metres.
ROOMS_M2 = 2 * 6.1 * 2.9
#: Standard deviation of a range, metres, and the share of the range that it grows by.
NOISE = [(0.005, 0), (0.01, 0), (0.02, 0), (0.03, 0), (0.005, 0.006)]


def straightened(log, poses):
    """Reduced walls turned into their axis, and the free space of the same scans."""
    walls = reduction.one_per_wall(segmap.build_map(log, poses, keep_points=True)).segments
    back = 0, 0, -np.radians(axis_of(walls))
    both = {"resolution": SIDE, "free_resolution": SIDE, "size": 12.8, "corner": (-2, -2)}
    return transform(back, walls), quadtree.build_map(log, compose(back, poses), **both)


def plain_rooms(walls, tree, kappa=1.3):
    """Free squares, the room of each, and the doors, by the steps of the chapter."""
    free, corner = tree.to_grid() <= 0.25, np.array(tree.bounds[:2])
    cells = cells_of(free, corner, SIDE, [offsets_of(walls, across) for across in (0, 1)])
    room, doorways = join_open(cells, SIDE)
    doors = join_narrow(cells, SIDE, room, doorways, kappa)
    middles = corner + SIDE * (np.argwhere(free)[:, ::-1] + 0.5)
    return middles, room[cells[free]], doors


def same_rooms(walls, tree):
    """The plan of the library, which has the rooms and doors of the plain steps."""
    middles, rooms, doors = plain_rooms(walls, tree)
    library = plan.floor_plan(walls, tree)
    there = library.room_at(middles)
    squares = np.zeros((len(set(rooms.tolist())), len(library.rooms)))  # in both of two rooms
    np.add.at(squares, (np.unique(rooms, return_inverse=True)[1][there >= 0], there[there >= 0]), 1)
    assert sorted(squares.argmax(1)) == [*range(len(library.rooms))]
    assert squares.max(1).sum() > 0.999 * squares.sum()
    assert np.mean(there < 0) < 0.03 and len(doors) == len(library.doors)
    widths = np.sort([door.width for door in library.doors])
    assert np.allclose(sorted(width for width, _, _ in doors), widths, atol=2 * SIDE + 1e-6)
    return library


def clinic_log(sigma, share, seed):
    sensor = replace(simulation.URG_04LX, sigma=sigma, range_share=share)
    way, rng = segmap.load("clinic").truth, np.random.default_rng(seed)
    return simulation.simulate(clinic_walls(), way, sensor=sensor, rng=rng)


@pytest.mark.parametrize("seed", [3, 4])
def test_the_plain_steps_give_the_rooms_of_the_library_in_the_clinic(seed):
    """Catches cells across a wall, and areas that are said to be too small but are not."""
    log = clinic_log(*NOISE[seed], seed)
    library = same_rooms(*straightened(log, log.truth if seed % 2 else pose_graph(log).poses))
    assert len(library.rooms) == 7 and not library.doubt
    assert 0.9 < sum(room.area for room in library.rooms[1:]) / ROOMS_M2 < 1.03


@pytest.mark.parametrize("seed", [0, 3])
def test_the_plain_steps_give_the_rooms_of_the_library_in_two_rooms(seed):
    """Catches an axis that is looked for along x alone, and a door that is lost in its wall."""
    building = two_rooms(np.random.default_rng(seed))
    log = log_of(building, simulation.SICK_LMS200, seed)
    library = same_rooms(*straightened(log, compose((0, 0, 0.3 * seed), log.truth)))
    assert len(library.rooms) == 2 and len(library.doors) == 1
