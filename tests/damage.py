"""Damaged files: samples of every format, what changes them, and what may become of a mutant."""

import gzip
import os
import random
import warnings

import numpy as np
from log_samples import NPZ, RAWSEEDS, SINGLE_FILES
from mrpt_samples import BINARY_FILES

from segmap import SegmentMap, readers
from segmap.arrays import LIMIT
from segmap.poses import between, compose
from segmap.readers import LogError, PoseGraph

with gzip.open(readers.data_file("malaga/malaga.log.gz"), "rt") as _file:
    MALAGA = "".join(line for _, line in zip(range(4), _file, strict=False))
SAMPLES = {name: text.encode() for name, text in (SINGLE_FILES | {"malaga": MALAGA}).items()}
SAMPLES |= BINARY_FILES | {"npz": NPZ}
#: Mutants of a sample, of a format that is new, of one with long lines, and of a file in a folder.
LIGHT, NEW, HEAVY, IN_FOLDER = 1100, 1000, 400, 300
NEWLY = ("gmapping", "dpslam", "wean", "csv", "rplidar", "ld19", "npz")
#: Damaged files that one run of this module reads, each with `on_error` "raise" and "skip".
COUNTS = {name: LIGHT if len(data) < 2000 else HEAVY for name, data in SAMPLES.items()}
COUNTS |= {"coreslam_13": 100} | dict.fromkeys(NEWLY, NEW)
COUNTS |= dict.fromkeys(BINARY_FILES, 300)  # four samples of one reader
MUTANTS = sum(COUNTS.values()) + IN_FOLDER * len(RAWSEEDS)

#: The same mutants in each run; another seed makes others.
SEED = os.environ.get("SEGMAP_SEED", "1")

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
            warnings.filterwarnings("ignore", ".*look like (degrees|millimetres)")  # they may
            log = readers.read(path, on_error=on_error)
    except LogError:
        return None
    assert len(log) and np.isfinite(log.times).all()
    assert all(np.isfinite(scan.points()).all() and np.isfinite(scan.angles).all() for scan in log)
    assert log.truth is None or np.isfinite(log.truth).all(1).any()
    return log


def check(path, place, name, count=None):
    """Read mutants of one file of a log: each is refused, or sound whether damage is skipped."""
    rng, content = random.Random(f"{SEED} {name}"), place.read_bytes()
    for number in range(count or COUNTS.get(name, IN_FOLDER)):
        place.write_bytes(mutated(content, rng))
        try:
            strict, lenient = outcome(path, "raise"), outcome(path, "skip")
            if strict is not None:
                assert lenient is not None and len(lenient) == len(strict)
                assert lenient.skipped == strict.skipped  # lines of no meaning, not damaged ones
        except Exception as fault:
            fault.add_note(f"mutant {number} of SEGMAP_SEED={SEED}: {place.read_bytes()[:2000]!r}")
            raise


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
