"""Exports of quadtree maps, read back by readers that know the formats and not the library."""

import json
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from quadtrees import room

from segmap.exports import write_geojson, write_svg
from segmap.quadtree import QuadtreeMap

assert room  # the fixture


# ----------------------------------------------------------------- GeoJSON and SVG
SQUARE = re.compile(r"M(\S+) (\S+?)h(\S+?)v(\S+?)h-(\S+?)z")


def test_geojson_holds_the_occupied_leaves(room, tmp_path):
    """Catches leaves lost, rings that run clockwise or stay open, and y before x."""
    write_geojson(tmp_path / "room.geojson", room)
    found = json.loads((tmp_path / "room.geojson").read_text())
    leaves, value = room.leaves(), room.leaf_occupancy()
    hit = np.flatnonzero(value > 0.5)
    assert found["type"] == "FeatureCollection" and 0 < len(found["features"]) == len(hit)
    assert found["crs"]["properties"]["name"].startswith("LOCAL_CS[")  # metres, no degrees
    rings = np.array([f["geometry"]["coordinates"] for f in found["features"]])[:, 0]
    assert {f["geometry"]["type"] for f in found["features"]} == {"Polygon"}
    assert rings.shape[1:] == (5, 2) and (rings[:, 0] == rings[:, -1]).all()
    corners = np.column_stack([leaves.x, leaves.y])[hit]
    np.testing.assert_allclose(rings[:, 0], corners, rtol=0, atol=1e-6)
    cross = rings[:, :-1, 0] * rings[:, 1:, 1] - rings[:, 1:, 0] * rings[:, :-1, 1]
    np.testing.assert_allclose(cross.sum(1) / 2, leaves.side[hit] ** 2, rtol=1e-3)
    told = [[f["properties"][k] for k in ("vis", "occ", "occupancy")] for f in found["features"]]
    assert max(len(repr(occupancy)) for *_, occupancy in told) == len("0.123456")
    expected = np.column_stack([leaves.vis, leaves.occ, value])[hit]
    np.testing.assert_allclose(told, expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize(("resolution", "digits"), [(0.01, 5), (0.25, 4), (8.0, 3), (1e4, -1)])
def test_drawings_keep_a_thousandth_of_a_cell(resolution, digits, tmp_path):
    """Catches corners rounded to centimetres, and cells of other sizes than the map's."""
    map = QuadtreeMap(resolution=resolution, corner=(0.123456, -9.876543))
    map.insert_scan((0.2, -9.8), [(3.0, -7.0)])
    leaves = map.leaves()
    (k,) = np.flatnonzero(leaves.occ)
    corner = np.array([leaves.x[k], leaves.y[k]])
    write_geojson(tmp_path / "it.geojson", map)
    (found,) = json.loads((tmp_path / "it.geojson").read_text())["features"]
    ring = np.array(found["geometry"]["coordinates"][0])
    assert (ring == ring.round(digits)).all() and (ring != ring.round(digits - 1)).any()
    write_svg(tmp_path / "it.svg", map)
    squares = np.array(SQUARE.findall((tmp_path / "it.svg").read_text()))[:, :2].astype(float)
    for low, side in ((ring.min(0), np.ptp(ring, axis=0)), (squares, resolution)):
        assert np.abs(low - corner).sum(-1).min() <= 1.01e-3 * resolution
        np.testing.assert_allclose(side, resolution, rtol=1.1e-3)


def test_svg_holds_every_leaf_in_its_grey(room, tmp_path):
    """Catches y downwards, black for free, and squares that are lost in a path."""
    write_svg(tmp_path / "room.svg", room)
    root = ET.parse(tmp_path / "room.svg").getroot()
    group = root[0]
    assert group.get("transform") == "scale(1 -1)"
    assert group.get("stroke") == "#0072b2"
    found = [
        (*map(float, square), int(path.get("fill")[1:3], 16))
        for path in group
        for square in SQUARE.findall(path.get("d"))
    ]
    leaves, value = room.leaves(), room.leaf_occupancy()
    sides = np.round([leaves.x, leaves.y, *[leaves.side] * 3], 5)
    expected = np.column_stack([*sides, np.rint(255 * (1 - value))])
    assert sorted(found) == sorted(map(tuple, expected.tolist()))
    left, top, wide, tall = map(float, root.get("viewBox").split())
    assert root.get("width") == "800"  # as that of segments
    hit = leaves.occ > 0
    assert left < leaves.x[hit].min() < leaves.x[hit].max() < left + wide
    assert top < -leaves.y[hit].max() < -leaves.y[hit].min() < top + tall
    assert float(root.get("height")) / float(root.get("width")) == pytest.approx(tall / wide, 0.01)
    assert abs(tall / wide - 1) > 0.1
