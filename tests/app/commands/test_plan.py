"""`segmap plan`: a floor plan of a log."""

import json

import pytest
from programs import program

import segmap
from segmap_app import files
from segmap_app.files import Session

main = program("segmap")


def test_a_plan_of_a_log_is_told_and_written(tmp_path, capsys):
    """Catches a plan that nobody writes, and rooms that are not told."""
    table, sheet = tmp_path / "rooms.csv", tmp_path / "room.svg"
    assert main(["plan", "room", "-o", str(table), "-o", str(sheet)]) == 0
    said = capsys.readouterr().out
    assert "planned   3 rooms" in said and "2 doors" in said and "GOOD" in said
    assert len(table.read_text().splitlines()) == 4
    assert "room 3" in sheet.read_text()


def test_a_plan_is_edited_as_typed_or_as_a_session_keeps_it(tmp_path, capsys):
    """Catches edits that a session keeps and no sheet shows, one in a place without a room that is
    not told, and a doubt that speaks of room 1 where nobody calls it so."""
    log, table, session = segmap.load("room"), tmp_path / "it.csv", tmp_path / "it.segmap"
    x, y, _ = log.truth[0]
    edits = [f"Name {x:.3f} {y:.3f} hall <1>", "Name 99 -99 garden", "NewDoor 0 4.5 0 5.4"]
    edits += ["Wall 99 -99"]
    files.write_session(session, Session(log, {}, edits={"edit": edits}))
    typed = [word for edit in edits for word in ("--edit", edit)]
    for source in ([str(session)], ["room", *typed]):
        shapes = tmp_path / "it.geojson"
        assert main(["plan", *source, "-o", str(table), "-o", str(shapes)]) == 0
        said = capsys.readouterr().out
        assert "edits that change nothing: Wall 99 -99 (no wall and no clutter there), " in said
        assert "Name 99 -99 garden (no room there)" in said and "3 doors" in said
        found = [one["properties"] for one in json.loads(shapes.read_text())["features"]]
        (outside,) = [one for one in found if one["kind"] == "door" and len(one["rooms"]) == 1]
        assert outside["rooms"] == ["hall <1>"] and outside["width"] == 0.9
        assert "where nothing was seen, windows or glass: 1" in said and "room 1" not in said
        assert [row.split(",")[0] for row in table.read_text().splitlines()].count("hall <1>") == 1
    assert main(["plan", "room", "--edit", "Name 1 hall"]) == 2
    assert "--edit: edit must be like" in capsys.readouterr().err


def test_names_of_an_earlier_session_are_edits(tmp_path):
    """Catches names of rooms that are passed over since sessions hold edits."""
    log, session = segmap.load("room"), tmp_path / "it.segmap"
    x, y, _ = log.truth[0].tolist()
    files.write_session(session, Session(log, {}, edits={"rooms": [[x, y, "the hall"]]}))
    assert files.read_session(session).edits == {"edit": [f"Name {x} {y} the hall"]}
    assert main(["plan", str(session), "-o", str(tmp_path / "it.csv"), "-q"]) == 0
    assert "the hall," in (tmp_path / "it.csv").read_text()


@pytest.mark.parametrize("name", ["-hall", "--edit", "-1", "- 2 -"])
def test_a_name_may_begin_with_a_dash(tmp_path, name):
    """Catches a name of a session that is taken for an option of the command."""
    log, table, session = segmap.load("room"), tmp_path / "it.csv", tmp_path / "it.segmap"
    held = {"edit": ["Name {:.3f} {:.3f} ".format(*log.truth[0, :2]) + name]}
    files.write_session(session, Session(log, {}, edits=held))
    assert main(["plan", str(session), "-o", str(table), "-q"]) == 0
    assert [row.split(",")[0] for row in table.read_text().splitlines()].count(name) == 1
