"""Panels without a kernel: `set_state` is what a browser sends when a control moves."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from segmap import LaserScan, Log, SegmentMap, course, fusion, load, panels, quality
from segmap.alignment import (
    backbone_steps,
    match_angles,
    match_points,
    odometry,
    pose_graph,
)
from segmap.course import (
    AnglePanel,
    BackbonePanel,
    BasicPanel,
    ClassesPanel,
    ClusterPanel,
    DistancePanel,
    FusionPanel,
    GroundTruthPanel,
    HybridPanel,
    IcpPanel,
    LandscapePanel,
    MatcherPanel,
    MeanShiftPanel,
    PolylinePanel,
    PoseGraphPanel,
    RayPanel,
    RoomPanel,
    StoragePanel,
)
from segmap.experiments import sweep
from segmap.extraction import extract_polylines
from segmap.panels import ComparePanel, LivePanel, Panel, QuadtreePanel, ScanPanel, slider, text
from segmap.panels._base import VIEW
from segmap.plotting import ERROR, RESULT, TRUTH
from segmap.quadtree import build_map
from segmap.reduction import basic_offline, basic_online, hybrid, mean_shift
from segmap.simulation import URG_04LX, drive, rectangular_room, simulate
from segmap.testing import assert_poses_equal

ROOM = rectangular_room(4.0, 3.0)
LOG = simulate(
    ROOM, drive([(1, 1), (3, 1)], step=0.5), sensor=URG_04LX, rng=np.random.default_rng(2)
)
WALLS = SegmentMap([[(0, y), (2, y)] for y in (0.0, 0.03, 0.10, 0.15, 1.0)])
#: Two that touch at (2, 0), six degrees apart: rho of both is near 0 there, and not elsewhere.
LEANING = SegmentMap([[(0, 0), (2, 0)], [(1.95, 0), (3.9, 0.2)], [(9, 9), (9, 9.1)]])

LOOP = load("corridor")
TREE = build_map(LOG[:1], LOG.truth[:1], resolution=0.02)

RUNS = sweep(
    {"walls": WALLS},
    ["fusion", "hybrid"],
    {"fusion": {"tolerance": [0.02, 0.06, 0.2]}, "hybrid": {"distance": [0.02, 0.2]}},
)


def lived(panel):
    panel.run(3)
    return panel


#: Every panel, a control of it, and a value that must change what is seen.
PANELS = {
    "angles": (lambda: AnglePanel(LOG), "rank", 1),
    "backbone": (lambda: BackbonePanel(LOG), "scan", 3),
    "basic": (lambda: BasicPanel(WALLS), "distance", 0.05),
    "classes": (lambda: ClassesPanel(build_map(LOG, LOG.truth)), "occupied", 0.9),
    "clusters": (lambda: ClusterPanel(LOG[0]), "gap", 0.05),
    "compare": (lambda: ComparePanel(WALLS, RUNS), "wanted", 50),
    "distance": (DistancePanel, "angle", 30),
    "fusion": (lambda: FusionPanel(WALLS), "tolerance", 0.12),
    "ground truth": (lambda: GroundTruthPanel(LOG), "late", 0.1),
    "hybrid": (lambda: HybridPanel(LEANING), "origin", 20),
    "matcher": (lambda: MatcherPanel(TREE, LOG[1].points(), LOG.truth[1]), "step", 3),
    "mean shift": (lambda: MeanShiftPanel(WALLS), "sigma", 0.60),
    "icp": (lambda: IcpPanel(LOG[0].points(), LOG[1].points(), (0.5, 0, 0)), "x", -0.2),
    "landscape": (lambda: LandscapePanel(LOG), "turn", 12),
    "live": (lambda: lived(LivePanel(LOG)), "tolerance", 0.005),
    "polylines": (lambda: PolylinePanel(LOG[0]), "tolerance", 0.005),
    "pose graph": (lambda: PoseGraphPanel(LOOP), "scan", 60),
    "quadtree": (lambda: QuadtreePanel(LOG), "doublings", 2),
    "rays": (RayPanel, "mask", False),
    "room": (lambda: RoomPanel(ROOM, (1, 1, 0)), "beams", 51),
    "scan": (lambda: ScanPanel(LOG), "step", 3),
    "storage": (lambda: StoragePanel(LOG, LOG.truth, ROOM), "resolution", 10.0),
}


@pytest.fixture(params=PANELS)
def driven(request):
    make, control, value = PANELS[request.param]
    return make(), control, value


def texts(panel):
    labels = [v.value for v in vars(panel).values() if type(v).__name__ == "Label"]
    return tuple(labels)


def test_all_panels_are_here():
    """Catches a new panel that these tests do not drive."""
    made = {type(make()).__name__ for make, _, _ in PANELS.values()}
    assert made == {
        name for room in (course, panels) for name in dir(room) if name[-5:] == "Panel"
    } - {"Panel"}


def test_a_moved_control_redraws(driven):
    """Catches a control that is shown but not observed."""
    panel, control, value = driven
    before = panel.picture.value, texts(panel), repr(panel)
    getattr(panel, control).set_state({"value": value})
    after = panel.picture.value, texts(panel), repr(panel)
    assert all(a != b for a, b in zip(before[:2], after[:2], strict=True))
    assert before[2] != after[2]


def test_every_end_of_every_slider_can_be_drawn(driven):
    """Catches a slider that reaches a value which the method refuses."""
    panel = driven[0]
    for control in [v for v in vars(panel).values() if type(v).__name__.endswith("Slider")]:
        for end in (control.min, control.max):
            control.set_state({"value": end})
            assert control.value == end


def test_moving_back_gives_the_same_picture(driven):
    """Catches a drawing that piles up, and noise that is drawn anew at each move."""
    panel, control, value = driven
    first, before = panel.picture.value, getattr(panel, control).value
    getattr(panel, control).value = value
    getattr(panel, control).value = before
    assert panel.picture.value == first


def test_shown_without_a_kernel(driven):
    """Catches a panel of which an untrusted or printed notebook shows nothing."""
    panel = driven[0]
    bundle = panel._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG") and len(bundle["image/png"]) < 30_000
    assert bundle[VIEW]["model_id"] == panel._view.model_id
    assert bundle["text/plain"] == repr(panel)
    assert not re.search(r"0x[0-9a-f]+|Widget|widget", repr(panel))


def test_pictures_are_not_stretched(driven):
    """Catches an image wider or narrower on the page than it was drawn."""
    panel = driven[0]
    width = int.from_bytes(panel.picture.value[16:20], "big")
    assert panel.picture.layout.width == f"{width}px"


class Counter(Panel):
    """Counts its drawings."""

    def __init__(self):
        self.drawn = 0
        self.position, self.label = slider("position", 1, 0, 9, 1, ""), text()
        self._assemble((self.position, self.label))

    def _draw(self, figure: Figure) -> None:
        self.drawn += 1
        self.label.value = str(self.position.value)


def test_one_move_is_one_drawing():
    """Catches a panel that redraws when its own texts change, or twice a move."""
    panel = Counter()
    panel.position.value = 4
    assert panel.drawn == 2 and panel.label.value == "4"
    panel.position.value = 4
    assert panel.drawn == 2


def test_a_callback_returns_nothing():
    """Catches a returned figure, which can hang a run without a display."""
    assert Counter()._redraw() is None


def test_sliders_wait_until_let_go():
    assert not slider("gap", 0.3, 0.1, 1.0, 0.05).continuous_update


@pytest.mark.parametrize(("step", "form"), [(1, "d"), (0.05, ".2f"), (0.005, ".3f"), (0.1, ".1f")])
def test_a_slider_shows_all_digits_of_its_step(step, form):
    assert slider("x", 1, 0, 2, step).readout_format == form


def test_fusion_panel_shows_what_fusion_finds():
    """Catches texts of another tolerance than the picture's."""
    panel = FusionPanel(WALLS, tolerance=0.02)
    panel.tolerance.value = 0.06
    found = fusion(WALLS, tolerance=0.06)
    assert np.array_equal(panel.reduction.segments, found.segments)
    assert panel.count.value == f"{len(found)} of 5 segments left"
    assert f"quality {quality(WALLS, found):.1%}" in panel.quality.value


def test_basic_panel_shows_what_basic_finds():
    """Catches degrees handed on as radians, and a box that is ticked without effect."""
    bend = [[(0, 0), (1, 0)], [(2.1, 0.1), (3, 0.2)], [(1.05, 0), (2.05, 0.1)]]
    map = SegmentMap(bend, scan=[0, 1, 2])
    panel = BasicPanel(map, distance=0.15, angle=np.radians(4))
    for online, method in ((False, basic_offline), (True, basic_online)):
        panel.online.value = online
        found = method(map, distance=0.15, angle=np.radians(4))
        assert np.array_equal(panel.reduction.segments, found.segments)
        assert panel.reduction.method == method.__name__
        assert panel.count.value == f"{len(found)} of 3 segments left"
        assert f"quality {quality(map, found):.1%}" in panel.quality.value


def test_distance_panel_turned_wall():
    """Catches degrees taken for radians: 2 m turned by 90 degrees about the common middle."""
    panel = DistancePanel()
    panel.angle.value = 90
    assert panel.segments[1].round(9).tolist() == [[0.0, -1.0], [0.0, 1.0]]
    assert panel.apart.value == "apart 1.000 m" and panel.angular.value == "angular 2.000 m"


def test_room_panel_without_noise_measures_exactly():
    panel = RoomPanel(ROOM, (1, 1, 0))
    assert "0.0 mm" not in panel.spread.value
    panel.noise.value = 0
    assert panel.spread.value == "range error 0.0 mm (root mean square)"


def test_room_panel_keeps_the_field_of_view():
    """Catches beams that are left out at one side instead of spread."""
    panel = RoomPanel(ROOM, (1, 1, 0))
    panel.beams.value = 51
    assert panel.scan.angles[[0, -1]] == pytest.approx(URG_04LX.angles[[0, -1]])


@pytest.mark.parametrize(
    ("log", "poses", "color"),
    [
        (LOG, None, TRUTH),
        (Log("raw", LOG.scans), None, ERROR),
        (LOG, LOG.truth, RESULT),
    ],
    ids=["truth", "odometry", "given"],
)
def test_the_way_is_drawn_in_the_colour_of_its_origin(log, poses, color):
    """Catches odometry drawn in green, as if it were the truth."""
    figure = Figure()
    ScanPanel(log, poses)._draw(figure)
    ways = [line for line in figure.axes[0].lines if line.get_linestyle() == "-"]
    assert [line.get_color() for line in ways] == [color]


def test_scan_panel_leaves_out_scans_without_a_pose():
    """Catches an index into all scans where only some have a pose."""
    truth = np.array([(np.nan,) * 3, (1, 1, 0), (np.nan,) * 3, (2, 1, 0)])
    panel = ScanPanel(Log("some", LOG.scans[:4], truth))
    panel.step.value = 1
    assert panel.scan is LOG.scans[3] and panel.step.max == panel.play.max == 1
    assert panel.index.value.startswith("scan 3 of 4")


def test_scan_panel_without_any_pose():
    with pytest.raises(ValueError, match=r"at least one of them finite, got \(1, 3\) with 0"):
        ScanPanel(Log("lost", [LaserScan([1.0], [0.0])]))


def test_hybrid_panel_shows_what_hybrid_finds():
    """Catches degrees taken for radians, thresholds that are not handed on, a lost filter."""
    panel = HybridPanel(LEANING, angle=5)
    assert panel.count.value == "2 of 3 segments left"
    assert panel.dropped.value == "1 dropped as too short"
    panel.angle.value = 6
    found = hybrid(LEANING, distance=0.20, angle=np.radians(6))
    assert np.array_equal(panel.reduction.segments, found.segments)
    assert panel.count.value == "1 of 3 segments left"
    assert panel.quality.value.startswith(f"quality {quality(LEANING, found):.1%}")
    panel.distance.value = 0.05
    assert panel.dropped.value == "0 dropped as too short"


def test_hybrid_panel_moves_the_origin_and_not_the_map():
    """Catches a result that is drawn in the frame of the moved origin, or moved the wrong way."""
    panel = HybridPanel(LEANING)
    panel.origin.value = 3
    found = hybrid(SegmentMap(LEANING.segments - [3, 0]))
    assert panel.reduction.segments == pytest.approx(found.segments + [3, 0])
    assert [len(panel.reduction), panel.origin.value] == [1, 3]
    panel.origin.value = 20
    assert panel.count.value == "2 of 3 segments left"


def test_hybrid_panel_draws_every_line_in_the_box_of_its_result():
    """Catches dots drawn by the other representative, far from the result of the same colour."""
    upright = np.array([[(1, 0), (1.1, 3)], [(1.1, 0), (1, 3)], [(1, 0), (1.1, 3)]])
    figure = Figure()
    HybridPanel(SegmentMap(upright))._draw(figure)
    dots, cross = (c.get_offsets() for c in figure.axes[1].collections[:2])
    assert len(dots) == 3 and len(cross) == 1
    assert (abs(dots - cross) < [10, 0.20]).all()


def test_mean_shift_panel_shows_what_mean_shift_finds():
    """Catches degrees taken for radians, an angle that is not one for 0.20 m, a lost slider."""
    walls = SegmentMap([[(0, 0), (2, 0)], [(0, 0.01), (1.95, 0.3)]])
    panel = MeanShiftPanel(walls)
    for sigma, angle in ((0.2, 10), (0.5, 10), (0.5, 1)):
        panel.sigma.value, panel.angle.value = sigma, angle
        found = mean_shift(walls, sigma=sigma, bandwidth=np.radians(angle) / 0.20)
        assert np.array_equal(panel.reduction.segments, found.segments)
        assert panel.count.value == f"{len(found)} of 2 segments left"
        assert panel.quality.value.startswith(f"quality {quality(walls, found):.1%}")
    assert panel.pieces.value == "8 pieces, 2 clusters"


def test_mean_shift_panel_draws_each_way_from_its_piece_to_its_centre():
    """Catches ways drawn in another order than the pieces, and clusters that share a colour."""
    figure = Figure()
    panel = MeanShiftPanel(WALLS)
    panel._draw(figure)
    ways, begin, end = figure.axes[1].collections
    assert np.array_equal([way[0] for way in ways.get_segments()], begin.get_offsets())
    assert np.array_equal([way[1] for way in ways.get_segments()], end.get_offsets())
    assert len(np.unique(end.get_facecolors(), axis=0)) == len(panel.directions.theta)


def test_the_compare_panel_shows_the_run_that_reduces_most_at_a_quality():
    """Catches the nearest run, one that falls short, and a map made with other thresholds."""
    panel = ComparePanel(WALLS, RUNS)
    for name in ("fusion", "hybrid"):
        for wanted in (40, 72, 96):
            panel.method.value, panel.wanted.value = name, wanted
            good = [r for r in RUNS.select(method=name) if r.quality >= wanted / 100]
            most = max(good, key=lambda r: r.reduction)
            assert panel.record == most
            assert len(panel.reduction) == panel.record.n_after
            assert panel.reduction.method == name


def test_the_compare_panel_shows_the_best_run_where_none_is_good_enough():
    """Catches an empty choice, and the run that reduces most."""
    poor = [r for r in RUNS.select(method="fusion") if r.quality < 0.97]
    panel = ComparePanel(WALLS, poor)
    panel.wanted.value = 98
    assert len(poor) > 1 and panel.record == max(poor, key=lambda r: r.quality)


def test_angle_panel_shows_what_match_angles_finds():
    """Catches the wrong pair of scans, a rank beyond the last, a second scan beyond the log."""
    panel = AnglePanel(load("room"), scan=3, apart=2)
    first, second = (extract_polylines(panel.log[k].points()) for k in (3, 5))
    found = match_angles(first, second, rng=np.random.default_rng(0))
    assert panel.match.pose == pytest.approx(found.pose, abs=1e-9)
    assert panel.verdict.value == f"match, overlap {found.overlap:.2f}"
    panel.rank.value = 9
    last = panel.candidates[-1]
    assert panel.found.value.startswith(f"{len(panel.candidates)} of {len(panel.candidates)}: ")
    assert f"{last.value:.2f} m match" in panel.found.value
    panel.scan.value, panel.apart.value = panel.scan.max, 40
    assert panel.verdict.value.startswith("match")  # the last two scans
    with pytest.raises(ValueError, match="log must hold at least two scans, got 1"):
        AnglePanel(LOG[:1])


def test_ground_truth_panel_measures_the_scans_whose_pose_it_withholds():
    """Catches an error over the poses that were given, a clock that is moved the other way."""
    panel = GroundTruthPanel(LOG, max_gap=10.0)
    assert panel.error.value == "wrong by 0.000 m on average"
    panel.late.value = 0.05
    speed = 0.5 / (LOG[1].time - LOG[0].time)
    used = panel.alignment.used
    off = np.mean(panel.alignment.poses[used, 0] - LOG.truth[used, 0])
    assert off == pytest.approx(-0.05 * speed, rel=1e-6)
    panel.late.value = 0
    panel.every.value = 3
    assert panel.alignment.used.tolist() == [True, True, True, True, False][: len(LOG)]


def test_ground_truth_panel_without_truth():
    with pytest.raises(ValueError, match="must hold true poses"):
        GroundTruthPanel(Log("raw", LOG.scans))


def test_icp_panel_ends_in_the_match_and_starts_where_it_is_told():
    """Catches degrees taken for radians, and a step beyond the last."""
    before, now = LOG[0].points(), LOG[1].points()
    panel = IcpPanel(before, now, (0.5, 0, 0))
    panel.turn.value = 5
    np.testing.assert_allclose(panel.steps[0].pose - panel.pose, [0.3, 0.3, np.radians(5)])
    panel.step.value = 60
    found = match_points(before, now, panel.steps[0].pose)
    np.testing.assert_allclose(panel.steps[-1].pose, found.pose, atol=1e-12)
    last = len(panel.steps) - 1
    assert panel.count.value.startswith(f"step {last} of {last}: ")


def test_icp_panel_of_too_few_points():
    with pytest.raises(ValueError, match="at least 6 points each, got 2 and 9"):
        IcpPanel(np.zeros((2, 2)), np.zeros((9, 2)))


def test_backbone_panel_shows_what_the_method_does():
    """Catches a panel one scan off, a rotation in radians, and a threshold without effect."""
    log = load("corridor")[:60]
    steps, panel = backbone_steps(log), BackbonePanel(log)
    for k in (2, 50):
        panel.scan.value = k
        turned = f"turned by {np.degrees(steps[k].rotation):.2f} deg"
        assert panel.turned.value == f"{turned}, {len(steps[k].lines.angle)} lines"
        assert panel.state.value == (steps[k].reason or "used")
    panel.min_length.value = 3.0
    assert len(panel.step.segments) < len(steps[50].segments)
    with pytest.raises(ValueError, match="log must hold at least one scan, got none"):
        BackbonePanel(log[:0])


def test_pose_graph_panel_shows_the_graph_as_it_is():
    """Catches a graph solved with other weights than the method's, and scans that are left out."""
    found = pose_graph(LOOP)
    panel = PoseGraphPanel(LOOP, found)
    assert_poses_equal(panel.poses, found.poses, atol=1e-4)
    loops = int(found.graph.loop.sum())
    assert loops and panel.count.value.endswith(f" {loops} loops")


def test_pose_graph_panel_takes_loops_only_when_they_are_found_and_wanted():
    """Catches a box without effect, and a loop known before its second end was seen."""
    panel = PoseGraphPanel(LOOP)
    panel.wheels.value = True
    assert float(panel.gap.value.split()[-2]) < 0.1
    panel.loops.value = False
    assert_poses_equal(panel.poses, LOOP.odometry, atol=1e-6)
    assert "loops not used" in panel.count.value and float(panel.gap.value.split()[-2]) > 1
    panel.loops.value, panel.scan.value = True, 140
    assert_poses_equal(panel.poses, LOOP.odometry[:141], atol=1e-6)
    assert panel.count.value.endswith(" 0 loops")


def test_pose_graph_panel_without_odometry_offers_no_wheels():
    scans = [LaserScan(s.ranges, s.angles, s.time) for s in LOOP[:10]]
    assert PoseGraphPanel(Log("bare", scans)).wheels.disabled


def test_pose_graph_panel_refuses_what_has_no_graph():
    found = pose_graph(LOOP[:10])
    for log, alignment in ((LOOP, odometry(LOOP)), (LOOP[:9], found), (LOOP[:1], None)):
        with pytest.raises(ValueError, match="must share a graph"):
            PoseGraphPanel(log, alignment)
