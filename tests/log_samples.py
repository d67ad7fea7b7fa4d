"""Small logs of every format, as texts: what the tests of the readers read and damage.

Each recording is of the same room: five beams, two scans, the robot 1 m farther in the second.
"""

import io
import json

import numpy as np

RANGES = "1.50 2.00 2.50 81.83 3.00"
TIMES = (1000.25, 1001.25)
#: Robot by its wheels, and where it really was: these two differ by more than a shift.
ODOMETRY = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.1))
TRUTH = ((5.0, 2.0, 0.5), (5.9, 2.5, 0.62))


def row(values) -> str:
    return " ".join(f"{value:.6f}" for value in values)


def flaser(pose, odometry, time=None, ranges=RANGES, keyword="FLASER") -> str:
    head = f"{keyword} {len(ranges.split())} {ranges} {row(pose)} {row(odometry)}"
    return head if time is None else f"{head} {time:.6f} robot {time - TIMES[0]:.6f}"


def robotlaser(laser, robot, time, ranges=RANGES, keyword="ROBOTLASER1", remissions="") -> str:
    n, m = len(ranges.split()), len(remissions.split())
    sensor = "0 -1.570796 3.141593 0.785398 50.0 0.01 0"
    return (
        f"{keyword} {sensor} {n} {ranges} {m} {remissions} {row(laser)} {row(robot)} "
        f"0.1 0.0 0.3 0.2 1000000.0 {time:.6f} robot {time - TIMES[0]:.6f}"
    )


def text(lines) -> str:
    return "\n".join(lines) + "\n"


def twice(*lines) -> list[str]:
    """Lines of both scans; in braces stand their number, time, odometry and truth."""
    return [
        line.format(k=k, time=TIMES[k], odometry=row(ODOMETRY[k]), truth=row(TRUTH[k]))
        for k in range(2)
        for line in lines
    ]


HEAD = "# message formats are described elsewhere", "PARAM robot_frontlaser_offset 0.3 robot 0.1"
DRIVE = "ODOM 0.0 0.0 0.0 0.1 0.0 0.0 1000.2 robot 0.0"
CARMEN = text([*HEAD, DRIVE, *map(flaser, TRUTH, ODOMETRY, TIMES), "SYNC done"])
CARMEN_NEW = text(map(robotlaser, TRUTH, ODOMETRY, TIMES))
G2O = text(
    f"VERTEX_SE2 {k} {row(TRUTH[k])}\n{robotlaser(ODOMETRY[k], ODOMETRY[k], TIMES[k])}\n"
    "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1"
    for k in range(2)
)
HOKUYO = (
    "# urg_mm angle_rad\n"
    + text(f"{1000 + k % 7} {0.01 * (k - 10):.4f}" for k in range(20))
    + "0 0.11\n7 0.12\n"
)
CORESLAM = text(
    f"{212387282 + 98000 * k} 14710 {29221 + 40 * k} {25178 + 50 * k} " + "0 " * 20 + "1500 " * 683
    for k in range(3)
)
CORESLAM_13 = text(
    f"{212387282 + 98000 * k} {40 * k} {-50 * k} " + "0 " * 10 + "1500 " * 682 for k in range(3)
)
GMAPPING = text(
    [
        "PARAM maxrange 80",
        "ODOM 0.000 0.000 0.000000 1000.000000",
        "ODO_UPDATE 2 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0 1000.000000",
        *twice(
            "FRAME {k} 0.220005 0.767718",
            f"LASER_READING 5 {RANGES} {{odometry}} {{time}}",
            "SM_UPDATE 3 0.1 0.2 0.3 -70.5 {truth} -20.25 0.4 0.5 0.6 -inf",
            "NEFF 27.666644",
        ),
        "RESAMPLE 3 1 1 1",
    ]
)
DPSLAM = text(twice("Odometry {odometry} ", f"Laser 5 {RANGES.replace('81.83', '8.18')}"))
WEAN = text(
    f"O {100 * x} {100 * y} {h} 1\nL {100 * x} {100 * y} {h} {100 * x + 25 * np.cos(h)} "
    f"{100 * y + 25 * np.sin(h)} {h} {'151 ' * 179}8183 {t}"
    for (x, y, h), t in zip(ODOMETRY, TIMES, strict=True)
)
#: Two turns of a cheap sensor: degrees, and short ranges that are no slip of units in metres.
TURNS = [(angle + turn / 8, 150 + angle) for turn in range(2) for angle in range(0, 360, 45)]
CSV = "angle_deg,range_mm,quality,time_ms\n" + text(
    f"{a},{r},47,{1000 * k}" for k, (a, r) in enumerate(TURNS)
)
RPLIDAR = "Ultra simple LIDAR data grabber for SLAMTEC LIDAR.\n" + text(
    f"{'S ' if a < 1 else '  '} theta: {a:03.2f} Dist: {r:08.2f} Q: 47 " for a, r in TURNS
)
LD19 = "[LDS][INFO][9.1][speed(Hz):9.9,size:8]\n" + text(
    f"[LDS][INFO][9.1]stamp(ns):{k}000000000,angle:{a},distance(mm):{r},intensity:200"
    for k, (a, r) in enumerate(TURNS)
)
SICK = text(f"{t}, 181, 0, " + ", ".join(["2.50"] * 180 + ["81.91"]) for t in TIMES)
HOKUYO_CSV = text(f"{t}, " + ", ".join(["1.25"] * 680 + ["0.007"]) for t in TIMES)
ODOMETRY_CSV = text(
    f"{t}, {k}, 100, 100, " + ", ".join(map(str, ODOMETRY[k])) for k, t in enumerate(TIMES)
)
GROUNDTRUTH = text(
    f"{t}, " + ", ".join(map(str, [*TRUTH[k], *np.zeros(9)])) for k, t in enumerate(TIMES)
)


def npz(**held) -> bytes:
    """A file of arrays."""
    file = io.BytesIO()
    np.savez(file, **held)
    return file.getvalue()


NPZ = npz(
    ranges=np.array([[1.5, 2.0, np.inf], [1.5, 0.0, 2.5]]),
    angles=np.array([-1.0, 0.0, 1.0]),
    odometry=np.array(ODOMETRY),
    times=np.array(TIMES),
    truth=np.array(TRUTH),
)
RPLIDAR_RECORD = text(
    f"{angle == 0}\t15\t{angle:.1f}\t{1000 + 10 * angle:.1f}"
    for _ in range(2)
    for angle in range(0, 360, 72)
)
ROSTOPIC = text(
    [
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angle_min,"
        "field.angle_max,field.angle_increment,field.time_increment,field.scan_time,"
        "field.range_min,field.range_max," + ",".join(f"field.ranges{k}" for k in range(5)),
        *(
            f"{int(when * 1e9)},{k},{int(when * 1e9)},laser,-1.5708,1.5708,0.7854,0.001,0.1,0.02,"
            f"80.0,{','.join(RANGES.split())}"
            for k, when in enumerate(TIMES)
        ),
    ]
)
XV11 = text(
    line
    for turn in range(2)
    for line in [
        "AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX",
        *(f"{a:.0f},{r},15,{0 if a else 8035}" for a, r in TURNS[turn * 8 : turn * 8 + 8]),
        "ROTATION_SPEED,5.01",
    ]
)
CSM = text(
    json.dumps({
        "nrays": 5, "theta": np.radians([-90, -45, 0, 45, 90]).tolist(), "valid": [1, 1, 1, 0, 1],
        "readings": [1.5, 2.0, 2.5, None, 3.0], "odometry": odometry, "true_pose": truth,
        "timestamp": [int(when), 250_000],
    })
    for when, odometry, truth in zip(TIMES, ODOMETRY, TRUTH, strict=True)
)  # fmt: skip
#: Every format that is a single file.
SINGLE_FILES = {
    "carmen": CARMEN, "carmen_new": CARMEN_NEW, "g2o": G2O, "hokuyo": HOKUYO, "coreslam": CORESLAM,
    "coreslam_13": CORESLAM_13, "gmapping": GMAPPING, "dpslam": DPSLAM, "wean": WEAN, "csv": CSV,
    "rplidar": RPLIDAR, "rplidar_record": RPLIDAR_RECORD, "rostopic": ROSTOPIC, "ld19": LD19,
    "xv11": XV11, "csm": CSM, "sick": SICK, "hokuyo_csv": HOKUYO_CSV,
}  # fmt: skip
#: Formats that hold no time.
TIMELESS = {"hokuyo", "dpslam", "rplidar", "rplidar_record", "xv11"}
#: Formats of one sensor, whose mirror turns in a time that is known, and of beams with a time each.
TURNING = {"coreslam", "coreslam_13", "hokuyo_csv", "csv", "ld19", "rostopic"}
CENTRE = "the laser sits at the robot's centre"
FIVE = "5 beams look over 180 degrees, counter-clockwise"
SICK_REACH = "ranges from {} m on met nothing"
WRAPS, COUNTER = "a scan ends where the angle wraps", "beams counter-clockwise"
URG = "a URG-04LX, which sees 5.6 m and turns in 0.1 s"
#: What the sample of each format leaves open, by the beginning of its words.
ASSUMED = {
    "carmen": {FIVE, SICK_REACH.format(50)},
    "carmen_new": {CENTRE},
    "g2o": set(),
    "hokuyo": {COUNTER},
    "coreslam": {URG, "wheels of 77 mm radius", "the laser sits 0.145 m ahead"},
    "coreslam_13": {URG, "wheels of 77 mm radius", "the laser sits 0.145 m ahead"},
    "gmapping": {FIVE, CENTRE, SICK_REACH.format(50)},
    "dpslam": {FIVE, CENTRE, SICK_REACH.format(8.18)},
    "wean": {"180 beams look over 180 degrees", SICK_REACH.format(50)},
    "csv": {COUNTER, WRAPS, "left out: 'quality'"},
    "rplidar": {"a text of ultra_simple"},
    "rplidar_record": {"a text of the package rplidar"},
    "rostopic": set(),
    "ld19": {WRAPS, "a text of LD06 and LD19"},
    "xv11": {COUNTER, WRAPS, "a text of GetLDSScan"},
    "csm": {CENTRE},
    "sick": {SICK_REACH.format(50)},
    "hokuyo_csv": {URG},
}
RAWSEEDS = {"SICK_FRONT.csv": SICK, "HOKUYO_FRONT.csv": HOKUYO_CSV}
RAWSEEDS |= {"ODOMETRY_XYT.csv": ODOMETRY_CSV, "run-GROUNDTRUTH.csv": GROUNDTRUTH}
#: How a text may lie in a file.
ENCODINGS = {
    "a mark": lambda text: b"\xef\xbb\xbf" + text.encode(),
    "utf-16": lambda text: text.encode("utf-16"),
    "utf-16 big": lambda text: b"\xfe\xff" + text.encode("utf-16-be"),
    "utf-32": lambda text: text.encode("utf-32"),
    "lines of Windows": lambda text: text.replace("\n", "\r\n").encode(),
}
