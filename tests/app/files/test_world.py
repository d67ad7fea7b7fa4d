"""Where a map lies on the earth, against places in space, arcs of ellipses, and by hand."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from segmap.exports import Frame, write_geojson, write_segments
from segmap.quadtree import QuadtreeMap
from segmap_app.files import Earth, Grid

A, F = 6378137.0, 1 / 298.257223563
E2 = F * (2 - F)
WALLS = [[(0, 0), (3, 0)], [(3, 0), (3, 2)]]


def beside(here, place):
    """East and north of a place in the plane that touches the ellipsoid, metres; within 1 km.

    Both are (longitude, latitude), degrees: the difference of their places in space.
    """
    (l1, p1), (l2, p2) = np.radians(here), np.radians(place)
    east = np.array([-np.sin(l1), np.cos(l1), 0])
    north = np.array([-np.sin(p1) * np.cos(l1), -np.sin(p1) * np.sin(l1), np.cos(p1)])
    there, origin = (
        A
        / np.sqrt(1 - E2 * np.sin(p) ** 2)
        * np.array([np.cos(p) * np.cos(a), np.cos(p) * np.sin(a), (1 - E2) * np.sin(p)])
        for a, p in ((l2, p2), (l1, p1))
    )
    return np.array([(there - origin) @ east, (there - origin) @ north])


@given(
    st.floats(-85, 85), st.floats(-179, 179), st.floats(1, 1000), st.floats(-3.1, 3.1),
    st.floats(-3, 3),
)  # fmt: skip
def test_a_kilometre_is_a_kilometre_in_its_direction(latitude, longitude, far, way, north):
    """Catches a sphere, radii of curvature exchanged, first order only (0.1 m), north clockwise.

    And the way back: east and north of the place give the point of the map again.
    """
    world = Earth(latitude, longitude, north)
    point = far * np.array([np.cos(way), np.sin(way)])
    found = world.coordinates(point)
    c, s = np.cos(north), np.sin(north)
    back = [(s, c), (-c, s)] @ beside((longitude, latitude), found)
    np.testing.assert_allclose(back, point, rtol=0, atol=2e-4)


def test_arcs_of_the_ellipse_by_closed_form():
    """At the equator 1 m north is 1 / M radians and 1 m east 1 / A; x east and y north."""
    (east, _), (_, north) = Earth(0, 0).coordinates([(100, 0), (0, 100)])
    assert east == pytest.approx(np.degrees(100 / A), abs=1e-10)
    assert north == pytest.approx(np.degrees(100 / (A * (1 - F) ** 2)), abs=1e-10)
    np.testing.assert_array_equal(Earth(-33.5, 151.2).coordinates((0, 0)), [151.2, -33.5])
    for world, digits in ((Earth(-33.5, 151.2), 10), (Grid("EPSG:25832", 5e5, 5e6), 5)):
        # to a hundredth of a millimetre, and no more
        here, found, ahead = world.coordinates([(0, 0), (1 / 3, 1 / 7), (0, 1)])
        assert (found == found.round(digits)).all() and (found != found.round(digits - 2)).all()
        assert abs(ahead[0] - here[0]) < 1e-9  # y points north where nobody says else
    assert Earth(0, 180).coordinates((100, 0))[0] < -179.99  # over the date line
    assert Earth(90, 0).coordinates((0, -1000))[1] == pytest.approx(89.991, abs=1e-4)  # no NaN


@pytest.mark.parametrize(("north", "at"), [(90, (3, 2)), (0, (-2, 3)), (180, (2, -3))])
def test_a_grid_is_turned_and_shifted_by_hand(north, at, tmp_path):
    """Catches a map that is turned the other way, and a reference system without its name."""
    world = Grid("EPSG:25832", 500_000, 5_800_000, np.radians(north))
    write_segments(tmp_path / "it.geojson", WALLS, world=world)
    found = json.loads((tmp_path / "it.geojson").read_text())
    assert found["crs"]["properties"]["name"] == "urn:ogc:def:crs:EPSG::25832"
    end = found["features"][1]["geometry"]["coordinates"][1]
    assert end == [500_000 + at[0], 5_800_000 + at[1]]


def test_degrees_name_no_reference_system_and_drawings_stay_in_metres(tmp_path):
    """Catches GeoJSON that RFC 7946 refuses, and a DXF in degrees."""
    world = Earth(52.5, 13.4, np.radians(60))
    for name in ("it.geojson", "it.csv", "it.dxf", "it.svg", "it.wkt"):
        write_segments(tmp_path / name, WALLS, world=world)
        if name != "it.geojson":
            write_segments(tmp_path / f"local_{name}", WALLS)
            assert (tmp_path / name).read_bytes() == (tmp_path / f"local_{name}").read_bytes()
    found = json.loads((tmp_path / "it.geojson").read_text())
    assert set(found) == {"type", "features"}
    ends = [each["geometry"]["coordinates"] for each in found["features"]]
    np.testing.assert_array_equal(ends, world.coordinates(WALLS))
    assert np.hypot(*beside(*ends[0])) == pytest.approx(3, abs=1e-4)


def test_squares_of_a_quadtree_lie_where_its_walls_do(tmp_path):
    """Catches rings that stay in metres, and rings that run clockwise."""
    map, world = QuadtreeMap(resolution=0.5, size=4), Earth(52.5, 13.4, 0.3)
    map.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    write_geojson(tmp_path / "it.geojson", map, world=world)
    found = json.loads((tmp_path / "it.geojson").read_text())
    ring = np.array(found["features"][0]["geometry"]["coordinates"][0])
    square = [(1, 0), (1.5, 0), (1.5, 0.5), (1, 0.5), (1, 0)]
    assert "crs" not in found
    np.testing.assert_array_equal(ring, world.coordinates(square))
    x, y = (ring - ring[0]).T
    assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() > 0


def test_a_map_that_lies_nowhere_keeps_its_digits():
    odd = np.array([[(-0.0, 1e-17), (0.1 + 0.2, 1e6)]])
    assert Frame().coordinates(odd).tobytes() == odd.tobytes()
