"""Pose graphs as g2o files: back again, the same to gtsam, and refused by name and line."""

import numpy as np
import pytest
from conftest import later
from damage import a_graph
from hypothesis import given, settings
from hypothesis import strategies as st

from segmap import LogError
from segmap.alignment import solve_graph
from segmap.exports import PoseGraph, write_graph
from segmap.poses import between
from segmap_app.files import read_graph

gtsam = later("gtsam")


@pytest.fixture
def gtsam_answers():
    return pytest.importorskip("gtsam", reason="gtsam is not installed here")


def chi2(graph: PoseGraph) -> float:
    left = between(graph.poses[graph.edges[:, 0]], graph.poses[graph.edges[:, 1]]) - graph.relative
    left[:, 2] = (left[:, 2] + np.pi) % (2 * np.pi) - np.pi
    return float(np.einsum("mi,mij,mj", left, graph.information, left))


def assert_same(found: PoseGraph, wanted: PoseGraph) -> None:
    for name in ("poses", "edges", "relative"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name))
    size = np.abs(wanted.information).max(initial=1.0)
    np.testing.assert_allclose(found.information, wanted.information, rtol=0, atol=1e-14 * size)


# ------------------------------------------------------------------------- back again
@settings(max_examples=25)
@given(seed=st.integers(0, 10**6), count=st.integers(2, 9), loops=st.integers(0, 5))
def test_a_graph_comes_back(seed, count, loops, tmp_path_factory):
    """Catches digits cut off, an entry of the information in another's place, and ids mixed up."""
    path = tmp_path_factory.getbasetemp() / "it.g2o"
    graph = a_graph(seed, count, loops)
    write_graph(path, graph)
    found = read_graph(path)
    assert_same(found, graph)
    assert found.ids.tolist() == list(range(count))
    write_graph(path, found._replace(ids=7 * found.ids + 3))
    again = read_graph(path)
    assert_same(again, graph)
    assert again.ids.tolist() == list(range(3, 7 * count, 7))


def test_the_lines_by_hand(tmp_path):
    """g2o's order, and its frame: across the way at its beginning is along it after a left turn."""
    graph = PoseGraph(
        [(0, 0, 0), (1, 2, 0.5)], [(0, 1)], [(1, 2, np.pi / 2)], [np.diag([1.0, 4.0, 9.0])]
    )
    write_graph(tmp_path / "it.g2o", graph)
    first, second, edge = (tmp_path / "it.g2o").read_text().splitlines()
    assert (first, second) == ("VERTEX_SE2 0 0.0 0.0 0.0", "VERTEX_SE2 1 1.0 2.0 0.5")
    assert edge.startswith("EDGE_SE2 0 1 1.0 2.0 1.5707963267948966 ")
    np.testing.assert_allclose(np.array(edge.split()[6:], float), [4, 0, 0, 1, 0, 9], atol=1e-15)


@pytest.mark.parametrize(
    ("kind", "six"), [("EDGE_SE2", "20 1 2 30 3 40"), ("EDGE2", "20 1 30 40 2 3")]
)
def test_both_orders_of_the_information(kind, six, tmp_path):
    """Catches the order of TORO in the place of g2o's, and lines that must come in an order."""
    text = f"FIX 2\n{kind} 2 4 1 0 0 {six}\nVERTEX2 4 1 0 0\nVERTEX_XY 9 0 0\nVERTEX_SE2 2 0 0 0\n"
    (tmp_path / "it.g2o").write_text(text)
    found = read_graph(tmp_path / "it.g2o")
    assert found.information.tolist() == [[[20, 1, 2], [1, 30, 3], [2, 3, 40]]]
    assert found.poses.tolist() == [[0, 0, 0], [1, 0, 0]] and found.edges.tolist() == [[0, 1]]


# ------------------------------------------------------------------------------ gtsam
def g2o_error(graph, values) -> float:
    """Sum of squares as g2o defines it, by gtsam's arithmetic of poses."""
    total = 0.0
    for k in range(graph.size()):
        edge = graph.at(k)
        i, j = map(values.atPose2, edge.keys())
        left = edge.measured().inverse().compose(i.between(j))
        r = np.array([left.x(), left.y(), left.theta()])
        total += r @ edge.noiseModel().information() @ r
    return total


def optimized(graph, values) -> np.ndarray:
    """The minimum of plain squares with the first pose held, `(n, 3)`."""
    noise = gtsam.noiseModel.Isotropic.Sigma(3, 1e-6)
    graph.add(gtsam.PriorFactorPose2(0, values.atPose2(0), noise))
    rules = gtsam.LevenbergMarquardtParams()
    rules.setRelativeErrorTol(1e-14)
    found = gtsam.LevenbergMarquardtOptimizer(graph, values, rules).optimize()
    poses = [found.atPose2(k) for k in range(found.size())]
    return np.array([(pose.x(), pose.y(), pose.theta()) for pose in poses])


@pytest.mark.parametrize("seed", range(3))
def test_gtsam_finds_the_same_errors_and_minimum(gtsam_answers, seed, tmp_path):
    """Catches information that is not turned: alike only where nothing turns."""
    for noise in (0.2, 0.002):
        ours = a_graph(seed, noise=noise)
        write_graph(tmp_path / "it.g2o", ours)
        graph, values = gtsam.readG2o(str(tmp_path / "it.g2o"), False)
        assert (graph.size(), values.size()) == (len(ours.edges), len(ours.poses))
        assert g2o_error(graph, values) == pytest.approx(chi2(ours), rel=1e-9)
    assert 2 * graph.error(values) == pytest.approx(chi2(ours), rel=0.03)  # it measures on an arc
    solved = solve_graph(*ours[:3], information=ours.information, scale=np.inf)
    np.testing.assert_allclose(optimized(graph, values)[:, :2], solved[:, :2], atol=1e-5)


THREE = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 1 1 1.5\n"
TWO = "EDGE_SE2 0 1 1 0 0 10 0 0 10 0 10\nEDGE_SE2 1 2 0 1 1.5 10 0 0 10 0 10\n"


@pytest.mark.parametrize(
    "line", ["EDGE_PRIOR_SE2 0 0 0 0 100 0 0 100 0 100", "VERTEX_SWITCH 9 1", "FIX 0"]
)
def test_lines_that_do_not_concern_the_poses_are_left_out_and_counted(line, tmp_path):
    """Catches a closed list of words: a prior of gtsam refuses the whole graph."""
    path = tmp_path / "it.g2o"
    path.write_text(f"{THREE}{line}\n{TWO}{line}\n")
    graph = read_graph(path)
    assert len(graph.poses) == 3 and graph.edges.tolist() == [[0, 1], [1, 2]]
    assert graph.left_out == {line.split()[0]: 2}


def test_keys_of_64_bits_are_names_of_vertices(tmp_path):
    """Catches the symbols of gtsam, whose first letter stands in the highest byte."""
    path = tmp_path / "it.g2o"
    for x0 in (ord("x") << 56, 0xE9 << 56, 2**64 - 2):
        edge = f"EDGE_SE2 {x0} {x0 + 1} 1 0 0 1 0 0 1 0 1\n"
        path.write_text(f"{edge}VERTEX_SE2 {x0 + 1} 1 0 0\nVERTEX_SE2 {x0} 0 0 0\n")
        graph = read_graph(path)
        assert graph.ids.tolist() == [x0, x0 + 1] and graph.edges.tolist() == [[0, 1]]
        assert graph.poses[1].tolist() == [1, 0, 0]
    path.write_text(f"VERTEX_SE2 {2**64} 0 0 0\n")
    with pytest.raises(LogError, match="expected the number of a vertex"):
        read_graph(path)


# ----------------------------------------------------------------------------- refused
LINES = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 9 0 0 9 0 9\n"
WRONG = {
    "edges only": ("FIX 0\n", None, "holds no vertex of a graph"),
    "another file": ("FLASER 1 2 3\n", 1, "expected a VERTEX_SE2 or EDGE_SE2 line"),
    "3D": ("FIX 0\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", 2, "VERTEX_SE2 or EDGE_SE2 line, got"),
    "twice": (LINES + "VERTEX_SE2 1 5 0 0\n", 4, "vertex 1 stands in the file twice"),
    "nowhere": (LINES + "EDGE_SE2 1 7 1 0 0 9 0 0 9 0 9\n", 4, "vertex 7 is not in the file"),
    "no pose": (LINES + "VERTEX_SE2 2 nan nan nan\n", 4, "expected metres and radians"),
    "short": (LINES + "EDGE_SE2 0 1 1 0 0 9 0 0 9 0\n", 4, "and 6 for its information"),
    "negative": (LINES + "EDGE_SE2 0 1 1 0 0 9 0 0 -9 0 9\n", 4, "nowhere negative"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_line_is_named(name, tmp_path):
    text, line, reason = WRONG[name]
    path = tmp_path / "it.g2o"
    path.write_text(text)
    with pytest.raises(LogError) as caught:
        read_graph(path)
    assert caught.value.line == line and reason in caught.value.reason
