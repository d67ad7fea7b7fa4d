"""Damaged files: samples of every format, what changes them, and what may become of a mutant."""

import gzip
import os
import random
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from conftest import later
from log_samples import NPZ, RAWSEEDS, SINGLE_FILES
from quadtrees import state

from segmap import SegmentMap, readers
from segmap.arrays import LIMIT
from segmap.exports import PoseGraph, write_graph, write_segments
from segmap.poses import between, compose
from segmap.quadtree import QuadtreeMap
from segmap.readers import LogError

files = later("segmap_app.files")

#: A map with numbers that are hard to write.
ODD_MAP = SegmentMap(
    [[(0.1, -0.0), (1 / 3, 5e-324)], [(LIMIT, -LIMIT), (1e7 - 1e-9, 2)], [(1, 1), (1, 1)]],
    scan=[-1, 2**53 - 1, 0],
)


def a_graph(seed=1, count=12, loops=6, noise=0.02) -> PoseGraph:
    """A robot that turns, loops closed; information of no symmetry at all."""
    rng = np.random.default_rng(seed)
    poses = np.zeros((count, 3))
    for k in range(1, count):
        poses[k] = compose(poses[k - 1], (1, 0.1, rng.normal(0, 1)))
    ends = [(k, k + 1) for k in range(count - 1)]
    ends += [tuple(rng.choice(count, 2, replace=False)) for _ in range(loops)]
    edges = np.array(ends)
    relative = between(poses[edges[:, 0]], poses[edges[:, 1]])
    relative += rng.normal(0, noise, relative.shape) * (1, 1, 0.3)
    half = rng.normal(0, 10, (len(edges), 3, 3))
    information = half @ half.swapaxes(1, 2) + np.diag([900, 400, 2000])
    return PoseGraph(poses + rng.normal(0, 0.01, poses.shape), edges, relative, information)


with gzip.open(readers.data_file("malaga/malaga.log.gz"), "rt") as _file:
    MALAGA = "".join(line for _, line in zip(range(4), _file, strict=False))
SAMPLES = {name: text.encode() for name, text in (SINGLE_FILES | {"malaga": MALAGA}).items()}
SAMPLES["npz"] = NPZ
#: The same mutants in each run: another seed makes others, `make fuzz` more of each sample.
SEED, MUTANTS = os.environ.get("SEGMAP_SEED", "1"), int(os.environ.get("SEGMAP_MUTANTS", "30"))

ODD = ["nan", "inf", "-inf", "-1", "0", "1e999", "1e308", "-1e308", "1e-320", "1_0", "²", "x", "#"]
ODD += ["1000000000", "9" * 400, "FLASER", "laser", "VERTEX2", "ROBOTLASER1", "\n", ",", "\0", " "]


def cut(data, a, b, bits):
    return data[:a] + data[a + b % 40 :]


def insert(data, a, b, bits):
    return data[:a] + bits + data[a:]


def overwrite(data, a, b, bits):
    return data[:a] + bits + data[a + len(bits) :]


def truncate(data, a, b, bits):
    return data[:a]


def change_word(data, a, b, bits):
    words = data.split(b" ")
    words[a % len(words)] = bits
    return b" ".join(words)


def swap_words(data, a, b, bits):
    words = data.split(b" ")
    a, b = a % len(words), b % len(words)
    words[a], words[b] = words[b], words[a]
    return b" ".join(words)


def repeat_line(data, a, b, bits):
    lines = data.split(b"\n")
    lines.insert(b % len(lines), lines[a % len(lines)])
    return b"\n".join(lines)


def pack(data, a, b, bits):
    packed = gzip.compress(data, 1, mtime=0)
    return packed[: a % (2 * len(packed))]


CHANGES = [cut, insert, overwrite, truncate, change_word, swap_words, repeat_line, pack]


def mutated(data: bytes, rng: random.Random) -> bytes:
    """The bytes after one to three changes; half of what is put in are words with a meaning."""
    for _ in range(rng.randint(1, 3)):
        bits = rng.choice(ODD).encode() if rng.random() < 0.5 else rng.randbytes(rng.randrange(7))
        place = rng.randrange(len(data) + 1)
        data = rng.choice(CHANGES)(data, place, rng.randrange(2**20), bits)
    return data


def outcome(path, on_error):
    """The log, checked to be sound, or None where reading it was refused."""
    try:
        with warnings.catch_warnings():
            for may in ("look like (degrees|millimetres)", "nothing was met"):
                warnings.filterwarnings("ignore", f".*{may}")
            log = readers.read(path, on_error=on_error)
    except LogError:
        return None
    assert len(log) and not np.isinf(log.times).any()
    assert all(np.isfinite(scan.points()).all() and np.isfinite(scan.angles).all() for scan in log)
    assert log.truth is None or np.isfinite(log.truth).all(1).any()
    return log


# ----------------------------------------------------------------------------- targets
#: Takes the folder and random numbers, writes a mutant and reads it: what became of it.
Target = Callable[[Path, random.Random], list[str]]


def log(name: str, content: bytes, folder: Path, rng: random.Random) -> list[str]:
    """One log, strict and lenient; a file of a recording is read with the others of its folder."""
    path, whole = folder / name, folder if name in RAWSEEDS else folder / name
    for other, text in RAWSEEDS.items() if name in RAWSEEDS else ():
        if other != "SICK_FRONT.csv":  # beside it the Hokuyo is not read
            (folder / other).write_text(text)
    path.write_bytes(mutated(content, rng))
    return strict_and_lenient(whole)


def strict_and_lenient(path: Path) -> list[str]:
    strict, lenient = outcome(path, "raise"), outcome(path, "skip")
    if strict is not None:  # what was left out are lines of no meaning, not damaged ones
        assert lenient is not None and len(lenient) == len(strict)
        assert lenient.skipped == strict.skipped
    return [
        f"{'read' if found else 'LogError'} {mode}"
        for found, mode in ((strict, "strict"), (lenient, "lenient"))
    ]


def bag(name: str, folder: Path, rng: random.Random) -> list[str]:
    """A bag of a kind, or one with packed chunks."""
    import bag_samples

    kind = "ros1" if name == "bz2" else name
    place, sound = folder / bag_samples.KINDS[kind], folder / "sound"
    if not sound.exists():
        bag_samples.write(folder, kind, **({"compression": "BZ2"} if name == "bz2" else {}))
        sound.write_bytes(place.read_bytes())
    place.write_bytes(mutated(sound.read_bytes(), rng))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # topics, places and times that are damaged
        return strict_and_lenient(place)


def given_to(
    read: Callable[[Path], object], name: str, what: object, folder: Path, rng: random.Random
) -> list[str]:
    """A map of segments or a pose graph; what is read of a mutant can be written again."""
    write = write_graph if name.endswith(".g2o") else write_segments
    path, sound = folder / "it", folder / name
    if not sound.exists():
        write(sound, what)
    path.write_bytes(mutated(sound.read_bytes(), rng))
    try:
        found = read(path)
    except LogError as fault:
        assert str(fault).startswith(str(path))
        return ["LogError"]
    if rng.random() < 0.1:
        write(folder / f"again-{name}", found)
    return ["read"]


def squares(folder: Path, rng: random.Random) -> list[str]:
    """A quadtree that is saved: refused by its name, or the same map."""
    path, map = folder / "map.npz", QuadtreeMap(resolution=0.05, size=0.8, corner=(0.1, -0.2))
    map.insert_scan((0.3, 0.4), [(-1.0, 2.0), (1.5, 0.2)], [(0.2, 2.0)])
    map.save(path)
    path.write_bytes(mutated(path.read_bytes(), rng))
    try:
        found = QuadtreeMap.load(path)
    except ValueError as fault:
        assert str(path) in str(fault)
        return ["LogError"]
    assert state(found) == state(map)
    return ["read"]


TARGETS: dict[str, Target] = {n: partial(log, n, data) for n, data in SAMPLES.items()}
TARGETS |= {n: partial(log, n, t.encode()) for n, t in RAWSEEDS.items()}
for _name in ("segments.csv", "segments.npz"):
    TARGETS[_name] = partial(given_to, readers.read_segments, _name, ODD_MAP)
TARGETS["graph"] = partial(
    given_to, lambda path: files.read_graph(path), "it.g2o", a_graph(3, 4, 2)
)
TARGETS["map.npz"] = squares
BAGS: dict[str, Target] = {n: partial(bag, n) for n in ("ros1", "db3", "mcap", "bz2")}
