"""A packed file, or a text in any encoding, is what is inside; an archive is refused in words."""

import bz2
import gzip
import lzma

import log_samples as samples
import numpy as np
import pytest
from log_samples import CARMEN, CARMEN_NEW, CSV, ENCODINGS
from programs import program

from segmap import LogError, exports, files, readers
from segmap_app.files import read_graph

main = program("segmap")

PACKINGS = {".gz": gzip.compress, ".xz": lzma.compress, ".bz2": bz2.compress}


def assert_logs_equal(found, wanted):
    """Scans, poses and times of two logs, bit for bit; the same is said of both."""
    assert len(found) == len(wanted) > 0 and found.causes == wanted.causes
    assert found.assumed == wanted.assumed and found.skipped.lines == wanted.skipped.lines
    for a, b in zip(found, wanted, strict=True):
        assert np.array_equal(a.ranges, b.ranges, equal_nan=True)
        assert np.array_equal(a.angles, b.angles)
    for name in ("odometry", "times"):
        assert np.array_equal(getattr(found, name), getattr(wanted, name), equal_nan=True)
    assert (found.truth is None) == (wanted.truth is None)
    assert wanted.truth is None or np.array_equal(found.truth, wanted.truth, equal_nan=True)


def written(path, data):
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("text", [CARMEN, CARMEN_NEW, CSV], ids=["carmen", "new", "csv"])
@pytest.mark.parametrize("packing", PACKINGS)
def test_a_packed_log_is_the_log(tmp_path, packing, text):
    """Catches a packing that one reader knows and another takes for letters."""
    plain = readers.read(written(tmp_path / "some.log", text.encode()))
    packed = written(tmp_path / f"some.log{packing}", PACKINGS[packing](text.encode()))
    assert_logs_equal(readers.read(packed), plain)
    assert readers.format_of(packed) == readers.format_of(tmp_path / "some.log")


@pytest.mark.parametrize("packing", ["", ".gz"])
@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("text", [CARMEN, CSV, samples.G2O], ids=["carmen", "csv", "g2o"])
def test_a_text_is_read_in_any_encoding(tmp_path, text, encoding, packing):
    """Catches a mark that becomes a letter of the first word, and letters of two bytes."""
    plain = readers.read(written(tmp_path / "some.log", text.encode()))
    data = ENCODINGS[encoding](text)
    other = written(tmp_path / f"some.log{packing}", PACKINGS[packing](data) if packing else data)
    assert_logs_equal(readers.read(other), plain)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_graphs_maps_and_options_are_read_in_any_encoding(tmp_path, encoding, capsys):
    """Catches encodings that only the readers of logs know."""
    write, graph = ENCODINGS[encoding], "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"
    graph += "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"
    found = read_graph(written(tmp_path / "it.g2o", write(graph)))
    assert len(found.poses) == 2
    exports.write_segments(tmp_path / "plan.csv", np.array([[(0, 0), (6, 0)], [(6, 0), (6, 4)]]))
    plan = (tmp_path / "plan.csv").read_text()
    assert len(readers.read_segments(written(tmp_path / "plan.csv", write(plan)))) == 2
    written(tmp_path / "it.toml", write("penalty = 0.1\nmethod = 'least_cost'\n"))
    written(tmp_path / "loops.csv", write("first;second\n0;20\n"))
    assert main(["map", "room", "--config", str(tmp_path / "it.toml")]) == 0
    assert "least_cost" in capsys.readouterr().out
    assert main(["map", "room", "--veto", str(tmp_path / "loops.csv")]) == 1
    assert "no loop was closed between scans 0-20" in capsys.readouterr().err


def test_damage_in_a_packed_log_is_told_of_the_packed_file(tmp_path):
    """Catches the name of a temporary folder in what a user reads."""
    alone = written(tmp_path / "bad.log.xz", lzma.compress((CARMEN + "FLASER 2 1\n").encode()))
    with pytest.raises(LogError, match="line ") as caught:
        readers.read(alone)
    assert caught.value.path == alone and caught.value.line


@pytest.mark.parametrize("packing", PACKINGS)
def test_a_packed_file_may_unpack_to_so_much_and_no_more(tmp_path, packing, monkeypatch):
    """Catches a file of some kilobytes that fills a disk, and a bound of one byte less."""
    monkeypatch.setattr(files, "LEAST_UNPACKED_BYTES", 100_000)
    monkeypatch.setattr(files, "MOST_UNPACKED_RATIO", 1)
    for size in (100_000, 100_001):
        data = (CARMEN + "\n" * size)[:size].encode()
        path = written(tmp_path / f"it{packing}", PACKINGS[packing](data))
        if size == 100_000:
            assert len(readers.read(path)) == 2
            continue
        for on_error in ("raise", "skip"):
            with pytest.raises(LogError, match="unpacks to more than 100000 bytes"):
                readers.read(path, on_error=on_error)
