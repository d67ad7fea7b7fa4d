"""Tables of beams as people have them: separator, decimal mark, encoding, head, units and names."""

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_samples import ENCODINGS

from segmap import LogError, readers

#: So many tables are drawn; `make fuzz` draws 5 000.
DRAWN = int(os.environ.get("SEGMAP_TABLES", "300"))
ANGLES = np.arange(-90.0, 91, 15)
RANGES = 2 + 0.07 * np.arange(13)
#: Separators, each with the decimal marks that it allows.
SEPARATORS = {",": ".", ";": ".,", "\t": ".,", " ": ".,"}
#: Names of a column, each with how many of its unit are a degree, a metre or a second; those that
#: say no unit are told by their numbers.
NAMES = {
    "angle": {
        "angle_deg": 1, "Theta (rad)": np.pi / 180, "AngleInDegrees": 1, "bearing[deg]": 1,
        "angle": 1, "THETA": np.pi / 180,
    },
    "range": {
        "range_mm": 1000, "dist_cm": 100, "Distance (m)": 1, "r[ft]": 1 / 0.3048, "DistInMM": 1000,
        "range [in]": 1 / 0.0254, "distance": 1000, "dist": 1,
    },
    "time": {"t": 1, "time_ms": 1000, "Timestamp[ns]": 1e9, "stamp (us)": 1e6},
    "quality": {"quality": 1, "Intensity": 1, "note": 1},
    "scan": {"scan": 1, "frame_id": 1},
}  # fmt: skip
#: What stands before the head.
NOTES = ["", "# recorded in the lab\n", "# a\n\n# b\n"]


@st.composite
def tables(draw):
    """The text of a table, how many scans it has, and whether their times are told."""
    separator = draw(st.sampled_from(sorted(SEPARATORS)))
    mark = draw(st.sampled_from(SEPARATORS[separator]))
    more = draw(st.lists(st.sampled_from(["time", "quality", "scan"]), unique=True))
    roles = draw(st.permutations(["angle", "range", *more]))
    names = {role: draw(st.sampled_from(sorted(NAMES[role]))) for role in roles}
    factors = {role: NAMES[role][name] for role, name in names.items()}
    if separator == " ":
        names = {role: name.replace(" ", "") for role, name in names.items()}
    count = draw(st.integers(1, 3))
    quote = draw(st.sampled_from(["", '"'])) if separator != " " else ""
    lines = [separator.join(f"{quote}{names[role]}{quote}" for role in roles)]
    for k in range(count):
        for angle, distance in zip(ANGLES, RANGES, strict=True):
            values = {
                "angle": angle,
                "range": distance,
                "time": 100.25 + k,
                "quality": 15,
                "scan": k,
            }
            texts = []
            for role in roles:
                number = f"{values[role] * factors[role]:.9f}"
                whole = role == "scan" or names[role] == "distance"
                texts.append(f"{float(number):.0f}" if whole else number)
            lines.append(separator.join(texts).replace(".", mark))
    first = draw(st.sampled_from([*NOTES, f"sep={separator}\n" if separator in ",;" else ""]))
    head = draw(st.sampled_from(["", "# "])) if first in NOTES and not quote else ""
    return f"{first}{head}" + "\n".join(lines) + "\n", count, "time" in roles, names.get("time")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


@given(tables(), st.sampled_from(["plain", *ENCODINGS]))
@settings(max_examples=DRAWN, deadline=None)
def test_all_ways_to_write_a_table_give_one_log(folder, table, encoding):
    """Catches a separator, a mark, a unit or a name that only one of the columns understands."""
    text, count, timed, clock = table
    path = folder / "it.csv"
    path.write_bytes(ENCODINGS.get(encoding, str.encode)(text))
    log = readers.read(path)
    assert len(log) == count
    for k, scan in enumerate(log):
        order = np.argsort(scan.angles)
        np.testing.assert_allclose(np.degrees(scan.angles[order]), ANGLES, atol=1e-5)
        np.testing.assert_allclose(scan.ranges[order], RANGES, atol=1e-6)
        told = timed and (clock != "t" or count > 1)  # one time alone says no unit
        assert (scan.time == pytest.approx(100.25 + k)) if told else np.isnan(scan.time)


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
    rows = [f"4,{a:.0f},{1000 * r:.0f}" for a, r in zip(ANGLES, RANGES, strict=True)]
    path.write_text("\n".join(["t,Angle,Distance", *rows]) + "\n")
    log = readers.read(path)
    np.testing.assert_allclose(log[0].ranges, RANGES)
    assert "'Angle' is in degrees, since it spans more than 2 pi" in log.assumed
    assert "'Distance' is in millimetres, since it holds whole numbers" in log.assumed
    assert "the column 't' says no unit: left out" in log.assumed
    path.write_text("Angle,Distance\n0.1,2.0\n0.2,2.1\n")
    with pytest.raises(LogError, match="the unit of 'Angle' is not said"):
        readers.read(path)
