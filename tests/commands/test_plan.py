"""`segmap plan`: a floor plan of a log."""

from programs import program

main = program("segmap")


def test_a_plan_of_a_log_is_told_and_written(tmp_path, capsys):
    """Catches a plan that nobody writes, and rooms that are not told."""
    table, sheet = tmp_path / "rooms.csv", tmp_path / "room.svg"
    assert main(["plan", "room", "--regular", "-o", str(table), "-o", str(sheet)]) == 0
    said = capsys.readouterr().out
    assert "planned   3 rooms" in said and "2 doors" in said and "GOOD" in said
    assert len(table.read_text().splitlines()) == 4
    assert "room 3" in sheet.read_text()


def test_doors_that_are_none_are_refused(capsys):
    """Catches a width of doors that is used before anybody looks at it."""
    assert main(["plan", "room", "--door", "2", "1"]) == 2
    assert "narrowest" in capsys.readouterr().err


def test_a_robot_that_is_found_has_a_room(tmp_path, capsys):
    """Catches a room that is looked for in another frame, and a plan in degrees."""
    plan, squares = tmp_path / "plan.geojson", tmp_path / "room.npz"
    assert main(["plan", "room", "-o", str(plan)]) == 0
    assert main(["occupancy", "room", "-o", str(squares)]) == 0
    capsys.readouterr()
    assert main(["locate", str(squares), "room", "--plan", str(plan)]) == 0
    assert "room      room " in capsys.readouterr().out
    assert main(["plan", "room", "--place", "52", "13", "-o", str(plan)]) == 0
    assert main(["locate", str(squares), "room", "--plan", str(plan)]) == 2
    assert "--place" in capsys.readouterr().err
