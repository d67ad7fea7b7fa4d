"""The ratchet: files and lines of every room, which only go down.

Whoever must raise a line says why in the same commit. `python tests/project/test_house.py` prints
the table as it is now.
"""

import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOUSE = tomllib.loads((ROOT / "tests/house.toml").read_text(encoding="utf-8"))["rooms"]
#: A room that is so much below its line lowers the line.
SLACK = 0.03
#: Folders, the largest of which fits on a screen; a file that is read to its end.
MOST_MODULES, MOST_LINES = 14, 400


def sources() -> list[Path]:
    folders = ("segmap", "notebooks/segmap_course", "tests")
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def measured() -> dict[str, tuple[int, int]]:
    """Files and lines of each folder below a package, with all below it; `.` for its own files."""
    found: dict[str, tuple[int, int]] = {}
    for path in sources():
        parts = path.relative_to(ROOT).parts
        top = 2 if parts[0] == "notebooks" else 1
        inside = len(parts) > top + 1
        room = "/".join(parts[top - 1 : top + 1]) if inside else f"{parts[top - 1]}/."
        files, lines = found.get(room, (0, 0))
        found[room] = files + 1, lines + len(path.read_text(encoding="utf-8").splitlines())
    return found


@pytest.mark.parametrize("room", sorted({*HOUSE, *measured()}))
def test_a_room_only_gets_smaller(room):
    """Catches a room that grows by what nobody asked for, and a line that is no longer one."""
    assert room in HOUSE, f"give {room} its line in tests/house.toml"
    files, lines = measured().get(room, (0, 0))
    most_files, most_lines = HOUSE[room]
    assert files <= most_files and lines <= most_lines, "find the simpler mechanism, or say why"
    assert lines >= (1 - SLACK) * most_lines - 10, "lower its line in tests/house.toml"


def test_folders_and_files_fit_in_the_head():
    """Catches a folder that nobody overlooks, and a file that nobody reads to its end."""
    counts: dict[Path, int] = {}
    for path in sources():
        helper = path.parent.name == "tests"  # helpers that the tests share stay on top
        counts[path.parent] = counts.get(path.parent, 0) + (not helper)
    assert {str(folder) for folder, count in counts.items() if count > MOST_MODULES} == set()
    lines = {str(p): len(p.read_text("utf-8").splitlines()) for p in sources()}
    ours = {name for name, count in lines.items() if count > MOST_LINES and "/tests/" not in name}
    assert ours == set()


if __name__ == "__main__":
    print("# Files and lines of each room, docstrings and blanks included.\n[rooms]")
    for name, (count, length) in sorted(measured().items()):
        print(f'"{name}" = [{count}, {length}]')
