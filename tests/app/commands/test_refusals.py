"""What a user sees of a file that cannot be read, and what it advises."""

import gzip
import lzma
import re
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from programs import program

BEAMS = "".join(f"{20 * (k % 18)};{66.6 + 3 * (k % 18):.1f}\n" for k in range(36))
#: Files that the tests of the readers do not refuse, and words: what it is, and what to do.
REFUSALS = {
    "empty.log": ("", "is empty, expected a log"),
    "diary.txt": (
        "Dear diary\n",
        r"with 'Dear diary'.*\n    log = segmap\.Log\(\"mine\", scans\)\n",
    ),
    "comments.txt": ("# nothing\n", "it has comments only"),
    "nounit.csv": (
        f"angle;dist\n{BEAMS}",
        "unit of 'angle' and 'dist' is not said.*--columns 'angle_deg.angle_rad.angle_deg_cw."
        "angle_rad_cw,range_mm.range_cm.range_m'",
    ),
    "norange.csv": ("angle_deg\n1\n", "no known format"),
    "two.zip": ("a.txt", "is an archive by zip: unpack it"),
    "two.tar": ("tar", "an archive by tar: .*unpack"),
    "book.xlsx": ("xl/workbook.xml", "is a workbook: save its sheet as CSV"),
    "it.zst": (b"\x28\xb5\x2f\xfd and so on", "is packed by zstd: `unzstd` unpacks it"),
    "twice.gz": (gzip.compress(lzma.compress(b"FLASER 1 1")), "packed twice: unpack it once"),
    "cut.gz": (b"\x1f\x8b\x08\x00broken", "broken or cut short"),
    "old.bag": (b"#ROSBAG V1.2\n", "Bag version 102 is not supported"),
    "pickle.npy": ("npy", "an array of numpy's, which these lines open:.*numpy.load"),
    "missing.log": (None, "is neither a file nor a folder|does not exist"),
}


def written(name, content):
    """The file itself; of what is no text the one that the word means."""
    path = Path(name)
    if content == "npy":
        np.save(path, np.array([[1], [1, 2]], object), allow_pickle=True)
    elif name.endswith((".zip", ".xlsx")):
        with zipfile.ZipFile(path, "w") as packed:
            packed.writestr(content, "hello\n")
    elif content == "tar":
        with tarfile.open(path, "w") as packed:
            packed.add("whole")
    elif content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())


@pytest.mark.parametrize("name", REFUSALS)
def test_each_refusal_says_what_it_is_and_what_to_do(name, tmp_path, monkeypatch, capsys):
    """Catches a refusal without advice, with the words of a program, or with bytes in it."""
    monkeypatch.chdir(tmp_path)
    Path("whole").mkdir()
    content, words = REFUSALS[name]
    written(name, content)
    code = program("segmap")(["map", name])
    beside = capsys.readouterr().err
    print(beside)
    assert code == 1 and re.search(words, beside, re.DOTALL), beside
    assert "\0" not in beside and "Traceback" not in beside and "Error:" not in beside
    assert name not in ("diary.txt", "nounit.csv") or "--skip" not in beside, "it helps nobody"
