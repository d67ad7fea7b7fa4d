"""The floor plan that a person mends, without a browser."""

import numpy as np
import pytest

from segmap.panels import PlanEditor
from segmap.plan import Join, Name, NewDoor, Split, floor_plan
from segmap.quadtree import map_of_grid


@pytest.fixture
def editor():
    """A room of 6 x 3 m, away from the origin."""
    corners = np.array([(10, 20), (16, 20), (16, 23), (10, 23)])
    walls = np.stack([corners, np.roll(corners, -1, axis=0)], 1)
    free = map_of_grid(np.ones((60, 120)), resolution=0.05, corner=(10, 20))
    return PlanEditor(floor_plan(walls, free))


def areas(editor):
    return sorted(round(room["area"], 1) for room in editor.state["rooms"])


def test_edits_are_done_taken_back_and_done_again(editor):
    """Catches an undo that loses what came before, and a redo after something else was done."""
    cut, name = Split((12, 20), (12, 23)), Name((15, 21), "hall")
    seen = []
    editor.observe(lambda change: seen.append(change["new"]), names="edits")
    for edit in (cut, name):
        editor.do(edit)
    assert areas(editor) == [6.0, 12.0] and editor.state["undo"] and not editor.state["redo"]
    editor.undo()
    editor.undo()
    assert areas(editor) == [18.0] and editor.edits == () and editor.state["redo"]
    editor.redo()
    assert editor.edits == (cut,) and {room["name"] for room in editor.state["rooms"]} == {
        "room 1",
        "room 2",
    }
    editor.do(Name((11, 21), "store"))
    editor.redo()
    assert [*map(str, editor.edits)] == ["Split 12 20 12 23", "Name 11 21 store"]
    assert seen[:2] == [(cut,), (cut, name)] and editor.plan.edits == editor.edits


def test_what_changes_nothing_is_said_and_not_kept(editor):
    """Catches an edit across nothing that is kept, or that takes the redo of others away."""
    editor.do(Split((12, 20), (12, 23)))
    editor.undo()
    editor.do(Join((11, 21), (40, 40)))
    assert editor.edits == () and areas(editor) == [18.0]
    assert editor.state["words"].startswith("nothing is changed: no room")
    editor.redo()
    assert areas(editor) == [6.0, 12.0]


def test_the_browser_gets_places_of_the_map_and_sends_them_back(editor):
    """Catches an axis that is swapped or upside down between Python and the browser."""
    (room,) = editor.state["rooms"]
    assert sorted(room["rings"][0]) == [[10, 20], [10, 23], [16, 20], [16, 23]]
    assert room["clear"] == pytest.approx(1.5, abs=0.02)
    assert editor.state["bounds"] == [9.5, 19.5, 16.5, 23.5]
    editor._handle_custom_msg({"edit": "Split 12 20 12 23"}, [])
    assert areas(editor) == [6.0, 12.0]
    editor._handle_custom_msg({"undo": True}, [])
    editor._handle_custom_msg({"redo": True}, [])
    assert editor.edits == (Split((12, 20), (12, 23)),)


def test_edits_that_are_set_are_shown(editor):
    """Catches edits of a session that are kept and not drawn."""
    editor.edits = (Split((12, 20), (12, 23)),)
    assert areas(editor) == [6.0, 12.0] and editor.plan.edits == editor.edits
    assert repr(editor).startswith("PlanEditor(2 rooms of 18.0 m") and "1 edit)" in repr(editor)
    bundle, _ = editor._repr_mimebundle_()
    assert bundle["image/png"][:4] == b"\x89PNG"


def test_a_refusal_is_of_the_edit_that_was_asked(editor):
    """Catches the words of an older edit that finds nothing either."""
    editor.edits = (Name((99, 99), "garden"),)
    editor.do(NewDoor((12, 21), (12, 22)))
    assert editor.state["words"].startswith("nothing is changed: ")


def test_doors_and_walls_are_drawn_in_the_browser_and_taken_back(editor):
    """Catches an edit of walls that the browser cannot send, or that undo leaves behind."""
    assert len(editor.state["wall"]) == 4
    assert editor.state["clutter"] == [] and editor.state["doors"] == []
    for text in ("NewDoor 11 20.1 12 20.1", "Split 13 20 13 23", "NewDoor 13 21 13 22"):
        editor._handle_custom_msg({"edit": text}, [])
    assert editor.state["doors"] == [[[11, 20], [12, 20]], [[13, 21], [13, 22]]]
    walls = editor.state["wall"]
    assert len(walls) == 5, "a drawn door is a gap"
    editor._handle_custom_msg({"edit": "Furniture 13 20"}, [])
    assert editor.state["words"].startswith("nothing is changed: neither a wall")
    editor._handle_custom_msg({"edit": "Wall 10 21"}, [])
    assert "it changes no room" in editor.state["words"] and editor.state["wall"] == walls
    for left in (1, 1, 0):
        editor.undo()
        assert len(editor.state["doors"]) == left
    for _ in range(3):
        editor.redo()
    assert len(editor.state["doors"]) == 2 and len(editor.edits) == 3
