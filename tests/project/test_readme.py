"""What README.md, environment.md and the Makefile tell a newcomer is true."""

import re
from dataclasses import replace

import pytest
from makefile import ROOT
from programs import program

README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMAND, FILES = (
    (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    for name in ("one_command", "logs_and_maps")
)


@pytest.fixture(scope="module")
def names():
    """What the ten lines of the README define."""
    block = re.search(r"## The package in ten lines\s+```python\n(.*?)```", README, re.DOTALL)
    scope: dict = {}
    exec(compile(block.group(1), "README.md", "exec"), scope)
    return scope


def test_the_ten_lines_run_and_mean_what_they_say(names):
    """Catches an example that the package has left behind."""
    log, walls, map, small = (names[name] for name in ("log", "segments", "map", "reduction"))
    assert len(log) == 225 and names["points"].shape[1:] == (2,)
    assert walls.shape[1:] == (2, 2) and len(small) < len(map)
    assert 0 < names["rate"] < 1 and 0 < names["quality"] < 1 and names["errors"].max() < 1
    assert (small.parents[names["members"]] == 0).all() and len(names["members"]) > 0


def test_the_session_of_commands_is_true(names, tmp_path, monkeypatch, capsys):
    """Catches a printed line, an option or a figure that the commands have left behind."""
    main = program("segmap")
    from segmap.alignment import METHODS

    block = re.search(r"```console\n\$ segmap (.*?)\n(.*?)```", COMMAND, re.DOTALL)
    assert f"`segmap {block.group(1).removesuffix(' -o malaga.png')}`" in README
    monkeypatch.chdir(tmp_path)
    known = replace(METHODS["pose_graph"], function=lambda log: names["alignment"])
    monkeypatch.setitem(METHODS, "pose_graph", known)
    assert main(block.group(1).split()) == 0
    said = [
        re.sub(r"[\d.]+ m?s$", "", text, flags=re.MULTILINE)
        for text in (capsys.readouterr().out, block.group(2))
    ]
    assert said[0].splitlines() == said[1].splitlines() and len(said[0].splitlines()) == 8
    assert (tmp_path / "malaga.svg").stat().st_size and (tmp_path / "malaga.png").stat().st_size


def test_the_lines_for_a_sensor_run(tmp_path, monkeypatch, capsys):
    """Catches an example that driver, emulator or matcher has left behind."""
    block = re.search(r"## With a sensor, or without\s+```python\n(.*?)```", FILES, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    source = block.group(1).replace("Emulator()", "Emulator(speed=3)")
    scope: dict = {}
    exec(compile(source, "README.md", "exec"), scope)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 50 and all(line.split()[-1].isdigit() for line in lines)
    assert scope["step"].score > -682 * 0.01
    assert scope["quadtree"].QuadtreeMap.load(tmp_path / "room.npz").scans == 50
