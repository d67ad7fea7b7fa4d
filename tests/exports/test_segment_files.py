"""Maps of segments in files: back bit for bit, read by other programs, or refused by name."""

import gzip
import io
import json
import tracemalloc
import xml.etree.ElementTree as ET
from dataclasses import fields

import numpy as np
import pytest
from damage import ODD_MAP
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of

from segmap import LogError, SegmentMap, build_map, fusion, load
from segmap.arrays import LIMIT
from segmap.exports import write_segments
from segmap.readers import read_segments

EMPTY = SegmentMap([])
MAPS = {
    "upright": SegmentMap([[(1, 0), (1, 2)], [(0, 1), (2, 1)]]),
    "empty": EMPTY,
    "short": SegmentMap([[(0, 0), (0.3, 0.1)]]),
    "one": SegmentMap([[(3, -1), (4, 1)]], [4]),
    "odd": ODD_MAP,
}
maps = st.integers(0, 5).flatmap(
    lambda n: st.builds(
        SegmentMap,
        arrays_of.arrays(float, (n, 2, 2), elements=st.floats(-LIMIT, LIMIT)),
        arrays_of.arrays(np.int64, n, elements=st.integers(1 - 2**53, 2**53 - 1)),
    )
)


def bits(map: SegmentMap) -> dict:
    """Everything that a map holds, byte for byte."""
    held = {field.name: getattr(map, field.name) for field in fields(map)}
    return {k: v if v is None else (v.dtype, v.shape, v.tobytes()) for k, v in held.items()}


def with_points() -> SegmentMap:
    log, poses = load("room")[:6], load("room").truth[:6].copy()
    poses[2] = np.nan
    return build_map(log, poses, keep_points=True)


# ------------------------------------------------------------------------- back again
@settings(max_examples=25)
@given(map=st.sampled_from([*MAPS.values()]) | maps)
@pytest.mark.parametrize("name", ["it.csv", "IT.CSV", "it.csv.gz", "it.npz"])
def test_any_map_comes_back_bit_for_bit(name, map, tmp_path_factory):
    """Catches digits cut off, a scan that is a float, an empty file, and a sign of zero.

    A reader that believes the name, too: here each file has that of another.
    """
    path = tmp_path_factory.getbasetemp() / name
    write_segments(path, map)
    other = path.replace(path.with_name("other.txt"))
    assert bits(read_segments(other)) == bits(map)


@pytest.mark.parametrize("order", ["C", "F"])
def test_save_keeps_points_and_sensors(order, tmp_path):
    """Catches what lies behind the segments, left out or mixed up; NaN for a scan without pose."""
    map = with_points()
    kept = np.array(map.points, order=order)
    map = SegmentMap(map.segments, map.scan, points=kept, first=map.first, sensors=map.sensors)
    map.save(tmp_path / "it.npz")
    assert np.isnan(map.sensors[2]).all()
    for found in (SegmentMap.load(tmp_path / "it.npz"), read_segments(tmp_path / "it.npz")):
        assert bits(found) == bits(map)
    map.save(tmp_path / "two.npz")
    assert (tmp_path / "two.npz").read_bytes() == (tmp_path / "it.npz").read_bytes()


def test_a_reduction_and_an_array_are_of_scan_0(tmp_path):
    """Catches a scan that is made up: a segment of a reduction comes from many."""
    before = SegmentMap([[(0, 0), (1, 0)], [(0, 0.01), (1, 0.01)]], [3, 4])
    for map in (fusion(before), before.segments):
        write_segments(tmp_path / "it.csv", map)
        found = read_segments(tmp_path / "it.csv")
        np.testing.assert_array_equal(found.segments, getattr(map, "segments", map))
        assert set(found.scan) == {0}


def test_many_equal_segments_are_no_bomb(tmp_path):
    """Catches a map that its own reader refuses since it shrinks to a thousandth."""
    map = SegmentMap(np.zeros((30_000, 2, 2)))
    map.save(tmp_path / "it.npz")
    assert (tmp_path / "it.npz").stat().st_size > map.segments.nbytes
    assert bits(SegmentMap.load(tmp_path / "it.npz")) == bits(map)


def test_spaces_and_ends_of_lines_of_other_programs(tmp_path):
    (tmp_path / "it.csv").write_bytes(b"# mine\r\nx1, y1,x2,y2,scan\r\n\r\n 1,2 ,3e0,4,5.0\r\n")
    found = read_segments(tmp_path / "it.csv")
    assert found.segments.tolist() == [[[1, 2], [3, 4]]] and found.scan.tolist() == [5]


# ---------------------------------------------------------------------- other programs
def geojson(path):
    """Catches y before x, and metres that a GIS takes for degrees."""
    found = json.loads(path.read_text())
    assert set(found) == {"type", "crs", "features"} and found["type"] == "FeatureCollection"
    name = found["crs"]["properties"]["name"]
    assert name.startswith("LOCAL_CS[") and 'UNIT["metre",1]' in name  # no degrees
    shapes = [each["geometry"] for each in found["features"]]
    assert {shape["type"] for shape in shapes} <= {"LineString"}
    scans = [each["properties"]["scan"] for each in found["features"]]
    return [shape["coordinates"] for shape in shapes], scans


def svg(path):
    """Catches a drawing upside down, lines that vanish or cover all of it, a frame that cuts."""
    root = ET.parse(path).getroot()
    (group,) = root
    assert group.get("transform") == "scale(1 -1)"
    assert "vector-effect" not in path.read_text()  # which many programs ignore
    ends = [[float(line.get(k)) for k in ("x1", "y1", "x2", "y2")] for line in group]
    left, top, wide, tall = map(float, root.get("viewBox").split())
    assert float(group.get("stroke-width")) * 800 / max(wide, tall) == pytest.approx(1.5, rel=1e-5)
    x, y = np.reshape(ends, (-1, 2)).T * [[1], [-1]]
    assert wide > 0 and tall > 0 and ((left < x) & (x < left + wide)).all()
    assert ((top < y) & (y < top + tall)).all()
    if ends:
        room = 0.02 * max(np.ptp(x), np.ptp(y), 1)
        assert (x.min() - left, y.min() - top) == pytest.approx((room, room), rel=1e-6)
        assert (wide - np.ptp(x), tall - np.ptp(y)) == pytest.approx((2 * room, 2 * room), rel=1e-6)
    sides = float(root.get("width")), float(root.get("height"))
    assert max(sides) == 800 and sides[0] / sides[1] == pytest.approx(wide / tall, rel=0.1)
    return ends, None


def wkt(path):
    """By shapely; one line of text."""
    text = path.read_text()
    assert text.count("\n") == 1 and text.startswith("MULTILINESTRING ")
    shapely = pytest.importorskip("shapely", reason="shapely is not installed here")
    return [part.coords[:] for part in shapely.from_wkt(text).geoms], None


def dxf(path):
    """Catches a drawing in millimetres, and one that ezdxf has to mend."""
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed here")
    drawing = ezdxf.readfile(path)
    assert (drawing.header["$INSUNITS"], drawing.dxfversion) == (6, "AC1009")
    audit = drawing.audit()
    assert not audit.errors and not audit.fixes
    lines = list(drawing.modelspace())
    assert {line.dxftype() for line in lines} <= {"LINE"}
    for tags in ("LINE\n8\n0", "30\n0.0", "31\n0.0"):  # on a layer, both heights given
        assert path.read_text().count(f"\n{tags}\n") == len(lines)
    ends = np.reshape([(line.dxf.start, line.dxf.end) for line in lines], (-1, 2, 3))
    assert not ends[..., 2].any()
    return ends[..., :2], None


@pytest.mark.parametrize("reader", [geojson, svg, wkt, dxf])
@pytest.mark.parametrize("map", MAPS.values(), ids=MAPS)
def test_other_programs_find_the_map(reader, map, tmp_path):
    """Catches rounded coordinates, and what a packed file holds besides."""
    path = tmp_path / f"it.{reader.__name__}"
    write_segments(path, map)
    write_segments(tmp_path / f"{path.name}.gz", map)
    assert gzip.decompress((tmp_path / f"{path.name}.gz").read_bytes()) == path.read_bytes()
    ends, scans = reader(path)
    kept = (map.segments[:, 0] != map.segments[:, 1]).any(-1) | (reader is not dxf)
    np.testing.assert_array_equal(np.reshape(ends, (-1, 2, 2)), map.segments[kept])
    assert scans is None or scans == map.scan.tolist()


@pytest.mark.parametrize("name", ["it.txt", "it.npz.gz", ".csv"])
def test_another_name_is_refused_with_those_that_are_known(name, tmp_path):
    known = r"\.npz, \.csv, \.svg, \.geojson, \.wkt, \.dxf, \.csv\.gz"
    with pytest.raises(ValueError, match=f"path: the name must end in {known}"):
        write_segments(tmp_path / name, ODD_MAP)
    assert list(tmp_path.iterdir()) == []


# ----------------------------------------------------------------------------- damaged
HEAD = "x1,y1,x2,y2,scan\n"
WRONG = {
    "nothing": ("", None, "is empty, expected the head x1,y1,x2,y2,scan"),
    "another head": ("a,b\n1,2\n", 1, "expected the head x1,y1,x2,y2,scan, got 'a,b'"),
    "a field less": (HEAD + "1,2,3,4,5\n1,2,3,4\n", 3, "expected 5 fields"),
    "a word": (HEAD + "1,2,wall,4,5\n", 2, "expected numbers for x1,y1,x2,y2,scan, got 'wall'"),
    "no number": (HEAD + "nan,2,3,4,5\n", 2, "expected metres for x1,y1,x2,y2"),
    "no scan": (HEAD + "1,2,3,4,inf\n", 2, "expected a whole number for scan, got inf"),
    "too far": (HEAD + "1,2,3,1.1e7,5\n", 2, "expected metres for"),
    "half a scan": (HEAD + "1,2,3,4,0.5\n", 2, "expected a whole number for scan, got 0.5"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_row_is_named(name, tmp_path):
    text, line, reason = WRONG[name]
    path = tmp_path / "it.csv"
    path.write_text(text)
    with pytest.raises(LogError) as caught:
        read_segments(path)
    assert caught.value.line == line and reason in caught.value.reason
    assert str(caught.value).startswith(f"{path}, line {line}: " if line else f"{path}: ")


def stored(**changes) -> bytes:
    target = io.BytesIO()
    held = {"format": np.array("segmap map 1"), "segments": ODD_MAP.segments, "scan": ODD_MAP.scan}
    np.savez(target, **{k: v for k, v in (held | changes).items() if v is not None})
    return target.getvalue()


TAMPERED = {
    "flat": ({"segments": np.zeros((3, 4))}, "damaged, segments must"),
    "half scans": ({"scan": np.full(3, 0.5)}, "damaged, scan must"),
}


@pytest.mark.parametrize("name", TAMPERED)
def test_arrays_that_are_no_map_are_refused(name, tmp_path):
    changes, reason = TAMPERED[name]
    path = tmp_path / "it.npz"
    path.write_bytes(stored(**changes))
    with pytest.raises(ValueError, match=rf"it\.npz: {reason}"):
        SegmentMap.load(path)
    with pytest.raises(LogError, match=reason) as caught:
        read_segments(path)
    assert str(caught.value).count("it.npz") == 1


def test_a_small_file_does_not_fill_the_memory(tmp_path):
    """Catches a table that unpacks to a thousand times the file. Arrays: `test_quadtree_files`."""
    rows = HEAD.encode() + (b"1,2,3,4," + bytes(5000).replace(b"\0", b" ") + b"5\n") * 400
    (tmp_path / "it.csv").write_bytes(gzip.compress(rows))
    tracemalloc.start()
    with pytest.raises(LogError, match=r"unpacks to more than \d+ bytes"):
        read_segments(tmp_path / "it.csv")
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()
