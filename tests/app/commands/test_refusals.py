"""What a user sees of a file that cannot be read, and what it advises."""

import gzip
import lzma
import re
import tarfile
import zipfile
from pathlib import Path

import bag_samples
import numpy as np
import pytest
from programs import program

BEAMS = "".join(f"{20 * (k % 18)};{66.6 + 3 * (k % 18):.1f}\n" for k in range(36))
ROS2 = "header:\n  frame_id: laser\nangle_min: 0.0\nranges:\n- 1.0\n- '...'\n---\n"
#: A file of each kind of fault, and words of its refusal: what it is, and what to do.
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
    "numbers.txt": (
        "1;2;3\n4;5;9\n7;8;1\n",
        "no name says which column is the angle.*--columns.*segmap.readers.read_csv",
    ),
    "damaged.csv": ("angle_deg,range_mm\n1,x\n", "got 'x'.*--skip leaves damaged lines out"),
    "degrees.csv": ("angle_deg,range_mm\n9000,1\n", "an angle within two turns"),
    "short.log": ("FLASER 3 1\n", "announces 3 ranges, but 1 fields follow|holds no scan"),
    "poses.csv": ("t,x,y,theta\n1,2,3,4\n", "holds poses and no scan: .*read_trajectory"),
    "echo.yaml": (ROS2, "YAML, which these lines open:.*yaml.safe_load_all"),
    "two.zip": ("a.txt", "is an archive by zip: unpack it"),
    "two.tar": ("tar", "an archive by tar: .*unpack"),
    "book.xlsx": ("xl/workbook.xml", "is a workbook: save its sheet as CSV"),
    "it.zst": (b"\x28\xb5\x2f\xfd and so on", "is packed by zstd: `unzstd` unpacks it"),
    "twice.gz": (gzip.compress(lzma.compress(b"FLASER 1 1")), "packed twice: unpack it once"),
    "cut.gz": (b"\x1f\x8b\x08\x00broken", "broken or cut short"),
    "cut.bag": ("bag", "is cut off.*`rosbag reindex`"),
    "cut.mcap": ("mcap", "is cut off.*`ros2 bag reindex`.*`mcap recover`"),
    "old.bag": (b"#ROSBAG V1.2\n", "Bag version 102 is not supported"),
    "noscan.bag": ("noscan", "holds no sensor_msgs/LaserScan, but the bag holds /odom"),
    "pickle.npy": ("npy", "an array of numpy's, which these lines open:.*numpy.load"),
    "it.npz": ("npz", "expected arrays ranges and angles.*no angles"),
    "missing.log": (None, "is neither a file nor a folder|does not exist"),
}


def written(name, content):
    """The file itself; of what is no text the one that the word means."""
    path = Path(name)
    if content in ("bag", "mcap", "noscan"):
        kind = "mcap" if content == "mcap" else "ros1"

        def story(m):
            for k in range(3):
                yield "/odom", 1e6 + k, *m.odometry(1e6 + k, (0.0, 0.0, 0.0))
                if content != "noscan":
                    yield "/scan", 1e6 + k, *m.scan(1e6 + k)

        whole = bag_samples.write(Path("whole"), kind, story)
        data = (whole / "it.mcap" if whole.is_dir() else whole).read_bytes()
        path.write_bytes(data if content == "noscan" else data[: int(0.9 * len(data))])
    elif content == "npy":
        np.save(path, np.array([[1], [1, 2]], object), allow_pickle=True)
    elif content == "npz":
        np.savez(path, ranges=np.ones((2, 3)))
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
