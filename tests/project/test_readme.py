"""What README.md, environment.md and the Makefile tell a newcomer is true."""

import re

from makefile import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
FILES = (ROOT / "docs" / "logs_and_maps.md").read_text(encoding="utf-8")


def test_the_ten_lines_run_and_mean_what_they_say():
    """Catches an example that the package has left behind."""
    block = re.search(r"## The package in ten lines\s+```python\n(.*?)```", README, re.DOTALL)
    exec(compile(block.group(1), "README.md", "exec"), names := {})
    log, walls, map, small = (names[name] for name in ("log", "segments", "map", "reduction"))
    assert len(log) == 225 and names["points"].shape[1:] == (2,)
    assert walls.shape[1:] == (2, 2) and len(small) < len(map)
    assert 0 < names["rate"] < 1 and 0 < names["quality"] < 1 and names["errors"].max() < 1
    assert (small.parents[names["members"]] == 0).all() and len(names["members"]) > 0


def test_the_lines_for_a_sensor_run(tmp_path, monkeypatch, capsys):
    """Catches an example that driver, emulator or matcher has left behind."""
    block = re.search(r"## With a sensor, or without\s+```python\n(.*?)```", FILES, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    source = block.group(1).replace("Emulator()", "Emulator(speed=3)")
    exec(compile(source, "README.md", "exec"), scope := {})
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 50 and all(line.split()[-1].isdigit() for line in lines)
    assert scope["step"].score > -682 * 0.01
    assert scope["quadtree"].QuadtreeMap.load(tmp_path / "room.npz").scans == 50
