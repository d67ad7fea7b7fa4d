"""A graph solved again: what moves, what stays, and what is refused."""

import numpy as np
import pytest

from segmap import load
from segmap.alignment import Graph, pose_graph, solve_graph
from segmap.poses import between, compose
from segmap.testing import assert_poses_equal

#: Once round a square of 2 m: every second scan is a key frame.
TURN = np.array((1.0, 0.0, np.pi / 4))
POSES = [np.array((3.0, 1.0, 0.5))]
for _ in range(7):
    POSES.append(compose(POSES[-1], TURN))
POSES = np.array(POSES)
EDGES = np.array([(0, 2), (2, 4), (4, 6), (6, 0)])
MOTIONS = between(POSES[EDGES[:, 0]], POSES[EDGES[:, 1]])


def drifted():
    """The wheels turn too far at each step; the first pose is right."""
    poses = [POSES[0]]
    for _ in range(7):
        poses.append(compose(poses[-1], TURN + (0, 0, 0.03)))
    return np.array(poses)


@pytest.mark.parametrize("scale", [3.0, np.inf])
def test_exact_motions_give_exact_key_frames(scale):
    """Catches exchanged ends of an edge, and a first pose that is moved to the origin."""
    found = solve_graph(drifted(), EDGES, MOTIONS, scale=scale)
    assert_poses_equal(found[::2], POSES[::2], atol=1e-4)


def test_other_scans_stay_beside_the_key_frame_before_them():
    """Catches scans left where they were, and scans hung on the key frame that follows."""
    start = drifted()
    found = solve_graph(start, EDGES, MOTIONS)
    assert_poses_equal(between(found[::2], found[1::2]), between(start[::2], start[1::2]))


def test_a_false_loop_is_outvoted_by_weights_and_believed_by_least_squares():
    """Catches a scale that is ignored."""
    rng = np.random.default_rng(1)
    poses = np.column_stack([np.arange(12.0), np.zeros((12, 2))])
    ends = np.array([(i, j) for i in range(12) for j in (i + 1, i + 2) if j < 12])
    motions = between(poses[ends[:, 0]], poses[ends[:, 1]]) + rng.normal(0, 0.003, (len(ends), 3))
    edges, motions = np.vstack([ends, (0, 11)]), np.vstack([motions, (3.0, 0, 0)])
    robust, plain = (solve_graph(poses, edges, motions, scale=s) for s in (3.0, np.inf))
    assert np.abs(robust - poses)[:, :2].max() < 0.1 < 1 < np.abs(plain - poses)[:, :2].max()


def test_information_decides_who_gives_way():
    """Catches weights that are not used: of two measured motions the surer one holds."""
    weak, strong = np.eye(3), 1e4 * np.eye(3)
    edges, motions = [(0, 1), (0, 1)], [(1.0, 0, 0), (2.0, 0, 0)]
    for weights, x in (([weak, strong], 2.0), ([strong, weak], 1.0)):
        found = solve_graph(np.zeros((2, 3)), edges, motions, information=weights, scale=np.inf)
        assert found[1, 0] == pytest.approx(x, abs=0.01)


def test_a_pose_graph_solved_again_stays():
    """Catches a graph that keeps other ends, motions or weights than it was solved from."""
    found = pose_graph(load("corridor")[:150])
    graph = found.graph
    again = solve_graph(found.poses, graph.edges, graph.relative, information=graph.information)
    assert_poses_equal(again, found.poses, atol=1e-4)


def test_no_edges_no_change():
    assert_poses_equal(solve_graph(POSES, [], []), POSES)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"poses": np.zeros((4, 2))}, "poses must be"),
        ({"relative": MOTIONS[:3]}, "relative must be"),
        ({"relative": MOTIONS * np.nan}, "finite"),
        ({"information": np.eye(3)}, "information must be"),
        ({"edges": EDGES + 2}, "scans 0 to 7, got 2 to 8"),
        ({"edges": EDGES - 1}, "got -1 to 5"),
        ({"edges": [(0, 2), (2, 0), (4, 6), (6, 4)]}, "scan 4 is not tied"),
        ({"scale": 0.0}, "scale must be positive"),
        ({"scale": np.nan}, "scale must be positive"),
    ],
)
def test_what_cannot_be_solved_is_refused(change, message):
    given = {"poses": POSES, "edges": EDGES, "relative": MOTIONS} | change
    with pytest.raises(ValueError, match=message):
        solve_graph(given.pop("poses"), given.pop("edges"), given.pop("relative"), **given)


def test_graphs_without_information_can_be_made():
    """The other methods have none."""
    assert Graph(EDGES, MOTIONS, np.zeros(4, bool), np.zeros(4)).information is None
