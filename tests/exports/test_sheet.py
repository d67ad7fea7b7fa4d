"""A sheet to print: what it says, and that a ruler reads it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from plan_buildings import rooms_of_squares

from segmap import SegmentMap
from segmap.exports import write_sheet

ROOM = np.array([[(0, 0), (12, 0)], [(12, 0), (12, 5)], [(12, 5), (0, 5)], [(0, 5), (0, 0)]], float)


def paths(text):
    """Corners of the lines that are drawn, points of an inch."""
    group = text.partition('id="LineCollection_1"')[2].partition("</g>")[0]
    lines = re.findall(r"M ([-\d.]+) ([-\d.]+) *L ([-\d.]+) ([-\d.]+)", group.replace("\n", " "))
    return np.array(lines, float).reshape(-1, 2, 2)


@pytest.mark.parametrize(("turn", "page"), [(False, (297, 210)), (True, (210, 297))])
def test_a_ruler_reads_it(turn, page, tmp_path):
    """Catches a scale of the screen, a map that is stretched or upside down, a cut corner."""
    walls = ROOM[..., ::-1] if turn else ROOM
    words = {"title": "hall", "verdict": "GOOD: all of it", "date": "2026-11-26"}
    write_sheet(tmp_path / "it.svg", SegmentMap(walls), **words)
    text = (tmp_path / "it.svg").read_text(encoding="utf-8")
    scale = float(re.search(r"1 : (\d+)", text).group(1))
    wide, high = map(float, re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', text).groups())
    assert (wide * 25.4 / 72, high * 25.4 / 72) == pytest.approx(page, abs=0.1)
    drawn = paths(text) * 25.4 / 72 * scale / 1000  # metres
    assert np.allclose(np.diff(drawn, axis=1), np.diff(walls, axis=1) * (1, -1), atol=0.002)
    ends = drawn.reshape(-1, 2) * 1000 / scale
    assert (ends > 11.9).all() and (ends < np.array(page) - 11.9).all()
    for each in (*words.values(), "m</text>"):
        assert each in text


def test_north_turns_with_the_plan(tmp_path):
    """Catches an arrow that turns the other way than the walls which are laid along the page."""
    plan, found = rooms_of_squares(2.0, 2.9), set()
    for axis in (0.0, 0.3):
        turned = replace(plan, axes=np.array([axis]))
        write_sheet(tmp_path / "it.svg", turned.walls, plan=turned, north=axis)
        text = (tmp_path / "it.svg").read_text(encoding="utf-8")
        found.add(re.search(r"<text [^>]*>N<", text).group())
    assert len(found) == 1


def test_north_formats_and_what_is_refused(tmp_path):
    """Catches a north that is always up, a file of another kind, and words that are marks."""
    for end, start in ((".pdf", b"%PDF"), (".png", b"\x89PNG"), (".svg", b"<?xml")):
        for name in ("one", "two"):
            write_sheet(tmp_path / f"{name}{end}", ROOM, title="$x <b>\u4e00\1", north=0.3)
        one, two = ((tmp_path / f"{name}{end}").read_bytes() for name in ("one", "two"))
        assert one.startswith(start) and one == two
    text = (tmp_path / "one.svg").read_text(encoding="utf-8")
    assert ">N<" in text and "$x &lt;b&gt;" in text and "<b>" not in text
    write_sheet(tmp_path / "none.pdf", np.zeros((0, 2, 2)))
    with pytest.raises(ValueError, match=r"must end in \.pdf, \.svg, \.png, got 'it\.dwg'"):
        write_sheet(tmp_path / "it.dwg", ROOM)
    with pytest.raises(ValueError, match="title has a NUL"):
        write_sheet(tmp_path / "it.pdf", ROOM, title="\0")
    with pytest.raises(ValueError, match="north must be"):
        write_sheet(tmp_path / "it.pdf", ROOM, north=90)
