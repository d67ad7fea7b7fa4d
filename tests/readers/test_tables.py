"""Tables of beams as people have them: separator, decimal mark, encoding, head, units and names."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_samples import ENCODINGS

from segmap import LogError, readers

ANGLES = np.arange(-90.0, 91, 30)
RANGES = np.array([2.0, 2.21, 2.42, 2.63, 2.84, 3.05, 3.26])
#: Separators, each with the decimal marks that it allows.
SEPARATORS = {",": ".", ";": ".,", "\t": ".,", " ": ".,"}
#: Names of a column, each with how many of its unit are a degree, a metre or a second.
NAMES = {
    "angle": {"angle_deg": 1, "Theta (rad)": np.pi / 180, "AngleInDegrees": 1, "bearing[deg]": 1},
    "range": {"range_mm": 1000, "dist_cm": 100, "Distance (m)": 1, "r[ft]": 1 / 0.3048},
    "time": {"t": 1, "time_ms": 1000, "Timestamp[ns]": 1e9, "stamp (us)": 1e6},
    "quality": {"quality": 1, "Intensity": 1},
}


@st.composite
def tables(draw):
    """The text of a table, and whether its times have a unit."""
    separator = draw(st.sampled_from(sorted(SEPARATORS)))
    mark = draw(st.sampled_from(SEPARATORS[separator]))
    more = draw(st.lists(st.sampled_from(["time", "quality"]), unique=True))
    roles = draw(st.permutations(["angle", "range", "scan", *more]))
    names = {role: draw(st.sampled_from(sorted(NAMES.get(role, {"scan": 1})))) for role in roles}
    factors = {role: NAMES.get(role, {}).get(name, 1) for role, name in names.items()}
    if separator == " ":
        names = {role: name.replace(" ", "") for role, name in names.items()}
    count = draw(st.integers(1, 3))
    lines = [separator.join(names[role] for role in roles)]
    for k in range(count):
        for angle, distance in zip(ANGLES, RANGES, strict=True):
            values = {"angle": angle, "range": distance, "time": 100.0 + k, "quality": 15}
            texts = [
                str(k) if role == "scan" else f"{values[role] * factors[role]:.9f}"
                for role in roles
            ]
            lines.append(separator.join(texts).replace(".", mark))
    first = draw(st.sampled_from(["", f"sep={separator}\n" if separator in ",;" else ""]))
    return first + "\n".join(lines) + "\n", count, "time" in roles and names["time"] != "t"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


@given(tables(), st.sampled_from(["plain", *ENCODINGS]))
@settings(max_examples=300, deadline=None)
def test_all_ways_to_write_a_table_give_one_log(folder, table, encoding):
    """Catches a separator, a mark, a unit or a name that only one of the columns understands."""
    text, count, timed = table
    path = folder / "it.csv"
    path.write_bytes(ENCODINGS.get(encoding, str.encode)(text))
    log = readers.read(path)
    assert len(log) == count
    for k, scan in enumerate(log):
        order = np.argsort(scan.angles)
        np.testing.assert_allclose(np.degrees(scan.angles[order]), ANGLES, atol=1e-5)
        np.testing.assert_allclose(scan.ranges[order], RANGES, atol=1e-6)
        assert (scan.time == pytest.approx(100.0 + k)) if timed else np.isnan(scan.time)


@pytest.mark.parametrize("head", ["", "sep=;\n", "# mine\n\nsep=;\n", "sep=;\nwinkel;abstand\n"])
def test_named_columns_begin_below_what_stands_before_the_numbers(tmp_path, head):
    """Catches the line of Excel that names the separator, taken for a beam."""
    path = tmp_path / "it.csv"
    path.write_text(f"{head}0,5;1500,5\n90;2000\n180;900\n")
    log = readers.read_csv(path, columns=["angle_deg", "range_mm"])
    assert log[0].ranges.tolist() == [1.5005, 2.0, 0.9] and not log.skipped
    assert np.degrees(log[0].angles[0]) == pytest.approx(0.5)


def test_units_that_the_numbers_tell_are_used_and_told(tmp_path):
    """Catches a unit guessed in silence, and a column nobody needs that stops the reading."""
    path = tmp_path / "it.csv"
    rows = [f"0.0,{a:.0f},{1000 * r:.0f}" for a, r in zip(ANGLES, RANGES, strict=True)]
    path.write_text("\n".join(["t,Angle,Distance", *rows]) + "\n")
    log = readers.read(path)
    np.testing.assert_allclose(log[0].ranges, RANGES)
    assert "'Angle' is in degrees, since it spans more than 2 pi" in log.assumed
    assert "'Distance' is in millimetres, since it holds whole numbers" in log.assumed
    assert "the column 't' says no unit: left out" in log.assumed
    path.write_text("Angle,Distance\n0.1,2.0\n0.2,2.1\n")
    with pytest.raises(LogError, match="the unit of 'Angle' is not said"):
        readers.read(path)
