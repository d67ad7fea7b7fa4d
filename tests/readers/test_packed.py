"""Whatever packs a file or encodes its text, every reader takes what is inside."""

import bz2
import gzip
import io
import lzma
import tarfile
import zipfile

import log_samples as samples
import numpy as np
import pytest
from log_samples import CARMEN, CARMEN_NEW, CSV, ENCODINGS, RAWSEEDS
from programs import program

from segmap import LogError, exports, readers

main = program("segmap")

zstd = pytest.importorskip("backports.zstd")

PACKINGS = {
    ".gz": gzip.compress,
    ".xz": lzma.compress,
    ".bz2": bz2.compress,
    ".zst": zstd.compress,
    ".xz.gz": lambda data: gzip.compress(lzma.compress(data)),
}


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


def tar(files):
    """Bytes of a tar of files by their names."""
    target = io.BytesIO()
    with tarfile.open(fileobj=target, mode="w") as packed:
        for name, data in files.items():
            about = tarfile.TarInfo(name)
            about.size = len(data)
            packed.addfile(about, io.BytesIO(data))
    return target.getvalue()


def zipped(files):
    """Bytes of a zip of files by their names."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, data in files.items():
            packed.writestr(name, data)
    return target.getvalue()


ARCHIVES = {
    ".zip": zipped,
    ".tar": tar,
    ".tar.gz": lambda files: gzip.compress(tar(files)),
    ".tgz": lambda files: gzip.compress(tar(files)),
    ".tar.xz": lambda files: lzma.compress(tar(files)),
}


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


@pytest.mark.parametrize("packing", PACKINGS)
def test_of_a_packed_log_that_is_cut_short_skip_reads_what_is_whole(tmp_path, packing):
    """Catches a packing that is read whole or not at all, and a loss in silence."""
    found = np.random.default_rng(2).uniform(1, 5, (3000, 60)).round(3)
    text = "".join(
        f"FLASER 60 {samples.row(ranges)} 0 0 0 0 0 {k}\n" for k, ranges in enumerate(found)
    )
    packed = PACKINGS[packing](text.encode())
    path = written(tmp_path / f"some.log{packing}", packed[: int(0.7 * len(packed))])
    with pytest.raises(LogError, match="is broken or cut short"):
        readers.read(path)
    if packing == ".xz.gz":  # packed twice: it is unpacked first
        return
    log = readers.read(path, on_error="skip")
    assert 0.3 * len(found) < len(log) < 0.8 * len(found) and log.name == "some"
    assert log.skipped.lines >= 1 and log[7].ranges == pytest.approx(found[7])


@pytest.mark.parametrize("packing", ["", ".gz", ".xz"])
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
    found = readers.read_graph(written(tmp_path / "it.g2o", write(graph)))
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


@pytest.mark.parametrize("archive", ARCHIVES)
def test_an_archive_of_one_log_is_that_log_whatever_lies_beside_it(tmp_path, archive):
    """Catches an archive that is read as text, and a README that hides the log."""
    plain = readers.read(written(tmp_path / "some.log", CARMEN.encode()))
    inside = {"README.txt": b"recorded in the lab\n", "day/some.log": CARMEN.encode()}
    for files in (inside, {"day/some.log.xz": lzma.compress(CARMEN.encode())}):
        packed = written(tmp_path / f"all{archive}", ARCHIVES[archive](files))
        assert_logs_equal(readers.read(packed), plain)
        assert readers.read(packed, on_error="skip").skipped.lines == 0


@pytest.mark.parametrize("archive", ARCHIVES)
def test_an_archive_of_a_folder_is_that_folder(tmp_path, archive):
    """Catches files of one log that are taken for several."""
    folder = tmp_path / "rawseeds"
    folder.mkdir()
    for name, text in RAWSEEDS.items():
        (folder / name).write_text(text)
    files = {f"rawseeds/{name}": text.encode() for name, text in RAWSEEDS.items()}
    packed = written(tmp_path / f"it{archive}", ARCHIVES[archive](files))
    assert_logs_equal(readers.read(packed), readers.read(folder))


@pytest.mark.parametrize("archive", ARCHIVES)
def test_two_logs_are_never_one_map(tmp_path, archive, capsys):
    """Catches two rooms in one map, and a second log that is left out in silence."""
    files = {"a.log": CARMEN.encode(), "b.log": CARMEN_NEW.encode()}
    packed = written(tmp_path / f"two{archive}", ARCHIVES[archive](files))
    for on_error in ("raise", "skip"):
        with pytest.raises(LogError, match=r"of 2 logs: a\.log, b\.log; read one") as caught:
            readers.read(packed, on_error=on_error)
        assert "\0" not in str(caught.value)
    assert len(readers.read(packed / "b.log")) == 2
    with pytest.raises(LogError, match=r"no log c\.log in it, but a\.log, b\.log"):
        readers.read(packed / "c.log")
    assert main(["info", str(packed)]) == 0
    said = capsys.readouterr().out
    assert f"{packed.name}/a.log" in said and f"{packed.name}/b.log" in said


def test_damage_in_an_archive_is_told_of_the_file_in_it(tmp_path):
    """Catches the name of a temporary folder in what a user reads."""
    files = {"day/bad.log": (CARMEN + "FLASER 2 1\n").encode(), "notes": b"none"}
    packed = written(tmp_path / "all.zip", zipped(files))
    with pytest.raises(LogError, match="line ") as caught:
        readers.read(packed)
    assert caught.value.path == packed / "day/bad.log" and caught.value.line
    alone = written(tmp_path / "bad.log.xz", lzma.compress(files["day/bad.log"]))
    with pytest.raises(LogError, match="line ") as caught:
        readers.read(alone)
    assert caught.value.path == alone


def test_an_archive_without_a_log_says_what_it_holds(tmp_path):
    packed = written(tmp_path / "no.tar", tar({"a.txt": b"hello", "b.txt": b"you"}))
    with pytest.raises(readers.UnknownFormat, match=r"without a log, it holds a\.txt, b\.txt"):
        readers.read(packed)


@pytest.mark.parametrize("name", ["../evil.log", "/evil.log", "a/../../evil.log"])
@pytest.mark.parametrize("archive", [".zip", ".tar"])
def test_an_archive_writes_nothing_elsewhere(tmp_path, archive, name):
    """Catches a name that leads out of the folder in which an archive is unpacked."""
    packed = written(tmp_path / f"it{archive}", ARCHIVES[archive]({name: CARMEN.encode()}))
    assert len(readers.read(packed)) == 2
    assert [p.name for p in tmp_path.iterdir()] == [packed.name]
    assert not (tmp_path.parent / "evil.log").exists()


def test_a_link_in_an_archive_leads_nowhere(tmp_path):
    target = io.BytesIO()
    with tarfile.open(fileobj=target, mode="w") as packed:
        about = tarfile.TarInfo("some.log")
        about.type, about.linkname = tarfile.SYMTYPE, "/etc/passwd"
        packed.addfile(about)
    with pytest.raises(LogError, match="without a log, it holds nothing"):
        readers.read(written(tmp_path / "it.tar", target.getvalue()))


@pytest.mark.parametrize("packing", [*PACKINGS, *ARCHIVES])
def test_a_file_that_unpacks_to_far_more_is_refused(tmp_path, packing):
    """Catches a file of some kilobytes that fills a disk."""
    data = b"FLASER " + bytes(200_000_000)
    pack = PACKINGS.get(packing) or (lambda content: ARCHIVES[packing]({"a.log": content}))
    packed = pack(data)
    if len(packed) > 1_000_000:
        return  # not packed at all
    with pytest.raises(LogError, match=r"unpacks to more than|longer than"):
        readers.read(written(tmp_path / f"it{packing}", packed))


def test_archives_in_an_archive_share_one_bound(tmp_path):
    """Catches a file of 60 kB that holds 1 500 archives of a megabyte each."""
    inner = ARCHIVES[".zip"]({"a.log": bytes(1_000_000)})
    many = io.BytesIO()
    with zipfile.ZipFile(many, "w") as packed:
        for k in range(60):
            packed.writestr(f"{k}.zip", inner)
    noise = np.random.default_rng(0).bytes(len(many.getvalue()) // 40)
    outer = ARCHIVES[".zip"]({"m.zip": many.getvalue(), "README.bin": noise})
    with pytest.raises(LogError, match="unpacks to more than"):
        readers.read(written(tmp_path / "it.zip", outer))


@pytest.mark.parametrize("packing", [*PACKINGS, *ARCHIVES])
def test_a_damaged_packed_file_is_told_as_one(tmp_path, packing):
    """Catches the exceptions of seven libraries."""
    pack = PACKINGS.get(packing) or (lambda content: ARCHIVES[packing]({"a.log": content}))
    whole = pack(b"FLASER 2 1 81.83 0 0 0 0 0 0\n" * 9)
    path = tmp_path / f"some.log{packing}"
    for place in range(0, len(whole), max(len(whole) // 60, 1)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :])
        for cut in (path.read_bytes(), whole[:place]):
            path.write_bytes(cut)
            try:
                readers.read(path)
            except LogError as fault:
                assert "some.log" in str(fault) and "\0" not in str(fault)
