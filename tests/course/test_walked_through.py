"""Each method of the project is walked through in a chapter: section, source, panel, exercise.

The table says where; the tests hold it against the chapters. What a method still lacks is a hole,
and the list of holes only shrinks. A method that a user registers needs no chapter.
"""

import json
import re
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import CHAPTERS, code_cells, markdown
from segmap_course import THESIS_GRIDS, thesis_results

from segmap import SegmentMap, alignment, extraction, matching, reduction


class Walk(NamedTuple):
    """Where a method is walked through; "" is a hole.

    `section` begins a heading, `source` is a function that is printed from `literal` or written
    there, `panel` a class of the course with the `controls` of the method, `exercise` a check.
    """

    chapter: str
    section: str
    source: str
    panel: str
    controls: tuple[str, ...]
    exercise: str


def walk(chapter, section, source, panel, controls, exercise):
    return Walk(chapter, section, source, panel, tuple(controls.split()), exercise)


#: One panel and one exercise may serve the methods of one mechanism.
WALKED = {
    "angle_correspondence": walk(
        "32", "The idea", "transforms", "AnglePanel", "heuristic distance far", "match_value"
    ),
    "segment_icp": walk(
        "32", "From a start", "segment_cost", "SegmentIcpPanel", "angle distance share", "pose_cost"
    ),
    "backbone": walk(
        "33",
        "Match, then turn",
        "mean_rotation",
        "BackbonePanel",
        "min_length distance angle step rotation",
        "least_translation",
    ),
    "point_icp": walk(
        "34", "The idea", "normal_equations", "IcpPanel", "x y turn step", "move_onto_walls"
    ),
    "global_segments": walk(
        "35",
        "Segments: all headings",
        "best_shifts",
        "GlobalPanel",
        "similar angle spread",
        "laplacian",
    ),
    "pose_graph": walk(
        "35",
        "How the graph of a log is made",
        "correlative_search",
        "PoseGraphPanel",
        "loops odometry",
        "edge_error",
    ),
    "basic_offline": walk(
        "51", "The whole method", "one_pass", "BasicPanel", "distance angle", "matches"
    ),
    "basic_online": walk(
        "51",
        "The order is part",
        "basic_online",
        "BasicPanel",
        "distance angle online",
        "merged",
    ),
    "hybrid": walk(
        "52",
        "Scan by scan",
        "find_wall",
        "HybridPanel",
        "distance angle min_length origin",
        "hough",
    ),
    "mean_shift": walk(
        "53", "Phase 1", "phase_2", "MeanShiftPanel", "sigma angle", "mean_shift_step"
    ),
    "fusion": walk("54", "The idea", "fusion", "FusionPanel", "tolerance", "best_shift"),
    "fusion_online": walk(
        "54", "Fusion on-line", "fusion_online", "OnlinePanel", "by tolerance", "best_shift"
    ),
    "hybrid_fusion": walk(
        "54",
        "Hybrid with Fusion",
        "hybrid_fusion",
        "OnlinePanel",
        "by tolerance every distance min_length",
        "best_shift",
    ),
    "segment_similarity": walk(
        "55", "What does it cost", "merged_in_turn", "LineErrorPanel", "by cost", "mean_line"
    ),
    "uncertain_parameters": walk(
        "55", "The same, cheaper", "fused", "LineErrorPanel", "by distance angle eps", "mean_line"
    ),
    "weighted_line_fitting": walk(
        "55",
        "Do two looks contradict",
        "add_pose",
        "LineErrorPanel",
        "by place heading chi2 gap",
        "pose_covariance",
    ),
    "viewing_sector": walk(
        "56", "The idea", "kept_pieces", "SectorPanel", "distance min_length forget", "verdict"
    ),
    "polyline": walk(
        "91",
        "Polyline: a chain",
        "polyline_through",
        "EarlyMethodsPanel",
        "by tolerance far bridge",
        "far_ends",
    ),
    "fuzzy_set": walk(
        "91",
        "Fuzzy set: walls along",
        "all_joined",
        "EarlyMethodsPanel",
        "by across along angle",
        "building_axis",
    ),
    "fuzzy_clustering": walk(
        "91",
        "Fuzzy clustering: points vote",
        "clustered",
        "EarlyMethodsPanel",
        "by cell noise",
        "memberships",
    ),
    "least_cost": walk(
        "58",
        "Each segment to its nearest",
        "exchanged",
        "LeastCostPanel",
        "penalty distance gap",
        "invented_metres",
    ),
    "one_per_wall": walk(
        "59", "One segment a wall", "grown", "WallsPanel", "by factor", "look_noise"
    ),
    "hill climbing": walk(
        "64", "Hill climbing", "hill_climb", "MatcherPanel", "matcher rounds", "climb_step"
    ),
    "hill climbing, thesis": walk(
        "64", "Hill climbing", "hill_climb", "MatcherPanel", "matcher rounds", "climb_step"
    ),
    "sample and rank": walk(
        "64",
        "Sample and rank",
        "sample_and_rank",
        "MatcherPanel",
        "matcher shift rotation",
        "climb_step",
    ),
    "sample and rank, thesis": walk(
        "64", "Sample and rank", "sample_and_rank", "MatcherPanel", "matcher", "climb_step"
    ),
    "extract_clusters": walk("21", "The idea", "cut", "ClusterPanel", "gap", "fit_line"),
    "extract_polylines": walk(
        "22", "The idea", "halve", "PolylinePanel", "tolerance", "farthest_point"
    ),
}
#: These have a section and nothing else: there is nothing to choose.
SECTIONS = {"odometry": ("11", "Odometry drifts"), "ground_truth": ("31", "The idea")}
#: What is missing, by method. Only ever take away from it.
HOLES: dict[str, set[str]] = {}
#: Thresholds that the theses vary, by method, and the control of each.
THESIS_THRESHOLDS = {
    "basic_offline": {"distance": "distance", "angle": "angle"},
    "basic_online": {"distance": "distance", "angle": "angle"},
    "hybrid": {"distance": "distance", "angle": "angle"},
    "mean_shift": {"sigma": "sigma"},
    "fusion": {"tolerance": "tolerance"},
}


@cache
def chapter(number: str) -> dict:
    (path,) = [path for path in CHAPTERS if path.name.startswith(f"{number}_")]
    return json.loads(path.read_text(encoding="utf-8"))


def headings(number: str) -> list[str]:
    return re.findall(r"^#+ (.+)$", markdown(chapter(number)), re.MULTILINE)


def code(number: str) -> str:
    return "\n".join(source for _, source, _ in code_cells(chapter(number)))


def test_every_method_of_the_project_is_in_the_table():
    """Catches a new method without a chapter."""
    names = [*alignment.METHODS, *reduction.METHODS, *matching.MATCHERS, *extraction.METHODS]
    assert sorted([*WALKED, *SECTIONS]) == sorted(names)


@pytest.mark.parametrize("name", [*WALKED, *SECTIONS])
def test_a_method_has_its_section(name):
    number, section = SECTIONS[name] if name in SECTIONS else WALKED[name][:2]
    assert any(heading.startswith(section) for heading in headings(number)), headings(number)


@pytest.mark.parametrize("name", WALKED)
def test_its_source_is_printed_or_written(name):
    """Catches a method that is called and not shown."""
    found = WALKED[name]
    printed = rf"getsource\((?:\w+\.)*{found.source}\)"
    assert re.search(rf"{printed}|^def {found.source}\(", code(found.chapter), re.MULTILINE)


@pytest.mark.parametrize("name", WALKED)
def test_its_panel_stands_in_the_chapter_and_has_its_thresholds(name):
    """Catches a panel without the control of what the method is about."""
    found = WALKED[name]
    assert f"course.{found.panel}(" in code(found.chapter)
    parts = {n for kind in getattr(course, found.panel).__mro__ for n in vars(kind)}
    assert set(found.controls) <= parts


@pytest.mark.parametrize("name", [name for name in WALKED if WALKED[name].exercise])
def test_its_exercise_stands_in_the_chapter(name):
    found = WALKED[name]
    assert f"course.check_{found.exercise}(" in code(found.chapter)


def test_the_list_of_holes_is_what_the_table_lacks():
    """Catches a hole that was filled and stays in the list, and a new one."""
    lacking = {
        field: {name for name, found in WALKED.items() if not getattr(found, field)}
        for field in Walk._fields
    }
    assert {field: names for field, names in lacking.items() if names} == HOLES
    assert sum(map(len, HOLES.values())) == 0


def test_what_the_theses_vary_is_in_the_panel_of_its_method():
    """Catches a threshold of A's runs that no slider has, or that ends before A's values."""
    runs = thesis_results()
    varied = {
        name: {
            column
            for column in ("distance", "angle", "sigma", "tolerance")
            if runs[runs["method"] == name][column].nunique() > 1
        }
        for name in THESIS_GRIDS
    }
    assert varied == {name: set(controls) for name, controls in THESIS_THRESHOLDS.items()}
    for name, controls in THESIS_THRESHOLDS.items():
        panel = getattr(course, WALKED[name].panel)(SegmentMap([[(0, 0), (1, 0)]]))
        for column, control in controls.items():
            tried = runs[runs["method"] == name][column]
            tried = np.degrees(tried) if column == "angle" else tried
            slid = getattr(panel, control)
            assert slid.min <= tried.min() + 1e-9 and tried.max() - 1e-9 <= slid.max


def test_live_reduction_is_shown_where_hybrid_with_fusion_is():
    """Catches a class for robots that no chapter makes."""
    assert "LiveReduction(" in code("54")
