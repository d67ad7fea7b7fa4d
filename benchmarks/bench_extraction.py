"""Segments of a scan: microseconds, precision and recall on the fixed workload."""

from collections.abc import Iterator

import numpy as np

from segmap.extraction import extract_polylines

from .measure import Row, missing, seconds, workloads

TARGETS = {"office_181": "<= 20 us (stretch 5)", "office_1081": "<= 80 us (stretch 30)"}


def rows() -> Iterator[Row]:
    load = workloads()
    if load is None:
        yield from missing("extraction")
        return
    for case, target in TARGETS.items():
        office = load.extraction_case(case)
        scans = [load.end_points(r, office.sensor.angles) for r in office.ranges]
        each = seconds(lambda scans=scans: [extract_polylines(p) for p in scans], 20) / len(scans)
        yield Row(f"extract_polylines, {case}", f"{1e6 * each:.1f} us", target)
        yield scored(
            "truth and found: >= 8 beams, 0.3 m",
            load,
            case,
            {},
            {"min_points": 8, "min_length": 0.3},
        )
        yield scored(
            "defaults against every visible wall",
            load,
            case,
            {"min_beams": 2, "min_length": 0.0},
            {},
        )
        yield scored("defaults against walls of >= 8 beams", load, case, {}, {})


def scored(how, load, case, truth, thresholds) -> Row:
    office = load.extraction_case(case, **truth)
    total = np.zeros(4)
    for ranges, pieces in zip(office.ranges, office.truth, strict=True):
        points = load.end_points(ranges, office.sensor.angles)
        total += load.score_segments(extract_polylines(points, **thresholds), pieces)
    precision, recall = total[0] / total[1], total[2] / total[3]
    return Row(f"  {how}", f"precision {precision:.4f}, recall {recall:.4f}", ">= .99 each")
