"""The simulated logs under data/: made anew from their seeds, read back, and what they show."""

import gzip
import hashlib
import importlib.util
from pathlib import Path

import numpy as np
import pytest

from segmap import readers
from segmap.angles import wrap
from segmap.poses import transform
from segmap.segments import point_distance
from segmap.simulation import cast_rays, corridor_loop, office

DATA = Path(__file__).parents[2] / "data"
#: Name of a log -> its size is below so many bytes.
NAMES = {"room": 150_000, "corridor": 150_000, "clinic": 300_000}


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("simulate_data", DATA / "simulate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", NAMES)
def test_a_simulated_log_can_be_made_anew_from_its_seed(name, script):
    """Catches a change of the simulation that leaves the committed log behind, or its checksum."""
    packed = (DATA / name / f"{name}.log.gz").read_bytes()
    assert len(packed) < NAMES[name] and packed[4:8] == bytes(4)  # no time stamp
    assert hashlib.sha256(packed).hexdigest() in (DATA / name / "README.md").read_text()
    lines = zip(
        gzip.decompress(packed).decode().splitlines(), script.text(name).splitlines(), strict=True
    )
    assert [k for k, (old, new) in enumerate(lines) if old != new] == []


def test_the_walls_of_the_clinic_are_those_that_it_was_simulated_in(script):
    """Catches a wall that was moved in the script alone, and a digit lost on the way."""
    walls = readers.read_segments(DATA / "clinic" / "walls.csv").segments
    np.testing.assert_array_equal(walls, script.clinic_walls())

    def tape(x, y, x_back):
        """From a wall on the right of one place to a wall on the left of another, metres."""
        ends = cast_rays(walls, (x, y, 0), [0]), cast_rays(walls, (x_back, y, np.pi), [0])
        return x + ends[0] - (x_back - ends[1])

    assert tape(4.4, 0.7, 4.4) == pytest.approx(9.0) and tape(0.6, 6, 0.6) == pytest.approx(1.2)
    assert tape(4.4, 2.8, 6.55) == pytest.approx(-0.1)


@pytest.mark.parametrize("name", NAMES)
def test_a_read_log_says_what_was_simulated(name, script):
    """Catches truth and odometry exchanged, beams shifted by one, units lost on the way."""
    read, made = readers.load(name), script.LOGS[name][0]()
    assert len(read) == len(made)
    np.testing.assert_allclose(read.times, made.times, atol=1e-6)
    for ours, theirs in ((read.truth, made.truth), (read.odometry, made.odometry)):
        np.testing.assert_allclose(ours[:, :2], theirs[:, :2], atol=1e-6)
        np.testing.assert_allclose(wrap(ours[:, 2] - theirs[:, 2]), 0, atol=1e-6)
    for ours, theirs in zip(read, made, strict=True):
        np.testing.assert_array_equal(ours.valid, theirs.valid)
        np.testing.assert_allclose(ours.points(), theirs.points(), atol=1e-9)


@pytest.mark.parametrize(
    ("name", "walls"),
    [
        ("room", office(rng=np.random.default_rng(2012), rooms=2)),
        ("corridor", corridor_loop()),
        ("clinic", readers.read_segments(DATA / "clinic" / "walls.csv").segments),
    ],
)
def test_by_its_truth_a_log_draws_its_walls_and_by_its_odometry_it_does_not(name, walls):
    """Catches a README that names another room, and wheels that do not drift."""
    log = readers.load(name)

    def off(poses):
        points = [transform(pose, s.points()) for pose, s in zip(poses, log, strict=True)]
        return point_distance(np.concatenate(points)[::5, None], walls).min(axis=1)

    assert np.sqrt(np.mean(off(log.truth) ** 2)) < 0.012  # 10 mm of noise along the beam
    assert np.mean(off(log.odometry)) > 0.05
