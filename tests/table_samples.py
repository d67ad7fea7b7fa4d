"""Tables of one recording as programs and people write them: three scans of twelve beams."""

import numpy as np
from log_samples import text

#: Three scans of twelve beams.
TURN = np.arange(0, 360.0, 30)
FAR = 2 + 0.21 * np.array([0, 3, 1, 4, 2, 5, 7, 6, 9, 8, 11, 10])
BEAMS = [(k, a, r) for k in range(3) for a, r in zip(TURN, FAR, strict=True)]
#: Times of the scans, where a table has them.
CLOCK = 1.6e9 + 0.2 * np.arange(3)


def lines(line, mark=None):
    """A line a beam, of the scan k, the angle a in degrees, r in metres."""
    found = [line(k, a, r) for k, a, r in BEAMS]
    return text(found if mark is None else [f.replace(".", mark) for f in found])


def xv11(k):
    beams = [f"{a:.0f},{1000 * r:.0f},15,0" for a, r in zip(TURN, FAR, strict=True)]
    return ["AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", *beams, "ROTATION_SPEED,5.01"]


def wide(names, begin=lambda k: [f"{0.2 * k:.1f}"], scale=1.0, mark=",", end=()):
    ranges = [f"{scale * r:.3f}" if scale == 1 else f"{scale * r:.0f}" for r in FAR]
    head = [mark.join(names)] if names else []
    return text([*head, *(mark.join([*begin(k), *ranges, *end]) for k in range(3))])


NUMBERS = ["0.0", "5.759587", "0.523599", "0.0", "0.1", "0.05", "12.0"]
KEYS = [
    *("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"),
    *("range_min", "range_max"),
]
NANOSECONDS = [str(1600000000000000000 + 200000000 * k) for k in range(3)]
CELL = str(tuple(FAR.round(3).tolist()))

#: Program -> a text of it, whether angles grow clockwise, and whether it tells times.
PROGRAMS = {
    "ultra_simple": (lines(lambda k, a, r: (
        f"{'S' if a == 0 else ' '}  theta: {a:06.2f} Dist: {1000 * r:08.2f} Q: 47")), True, False),
    "frame_grabber": ("#RPLIDAR SCAN DATA\n#COUNT=36\n#Angule\tDistance\tQuality\n" + lines(
        lambda k, a, r: f"{a:.4f}\t{1000 * r:.1f}\t47"), True, False),
    "record_measurments": (
        lines(lambda k, a, r: f"{a == 0}\t15\t{a}\t{1000 * r:.1f}"), True, False),
    "xv11": (text(line for k in range(3) for line in xv11(k)), False, False),
    "xv11 as it is sent": (
        "\x1a".join("getldsscan\r\n" + "\r\n".join(xv11(k)) + "\r\n" for k in range(3)) + "\x1a",
        False, False),
    "ld19": (lines(lambda k, a, r: (
        f"[LDS]stamp(ns):{NANOSECONDS[k]},angle:{a:.2f},distance(mm):{1000 * r:.0f},intensity:9")),
        True, True),
    "rostopic -p": (
        wide(["%time", "field.header.stamp", *(f"field.{key}" for key in KEYS),
              *(f"field.ranges{k}" for k in range(12)), "field.intensities0"],
             lambda k: ["7", NANOSECONDS[k], *NUMBERS], end=["47"]), False, True),
    "ros2 --csv": (
        wide([], lambda k: ["1600000000", str(200000000 * k), "laser", *NUMBERS],
             end=["47.0"] * 12), False, True),
    "bagpy": (
        wide(["Time", "header.seq", "header.stamp.secs", "header.stamp.nsecs", "header.frame_id",
              *KEYS, *(f"ranges_{k}" for k in range(12))],
             lambda k: ["7", str(k), "1600000000", str(200000000 * k), "laser", *NUMBERS]),
        False, True),
    "rosbag_to_csv": (
        text([
            "time,.header.stamp.secs,.header.stamp.nsecs,.ranges,.intensities,." + ",.".join(KEYS),
              *(f'2020/09/13/12:26:40,1600000000,{200000000 * k},"{CELL}",(),{",".join(NUMBERS)}'
                for k in range(3))]), False, True),
    "plotjuggler": (
        wide(["__time", *(f"/scan/{key}" for key in KEYS),
              *(f"/scan/ranges[{k}]" for k in range(12))],
             lambda k: [f"{CLOCK[k]:.3f}", *NUMBERS]) + "1600000001.0" + "," * 19 + "\n",
        False, True),
}  # fmt: skip


def xy(k, a, r):
    return f"{r * np.cos(np.radians(a)):.5f},{r * np.sin(np.radians(a)):.5f},{k}"


#: What somebody writes -> its text, and what is declared of it.
DECLARED = {
    "no names": (
        lines(lambda k, a, r: f"{0.2 * k:.1f},{a:.2f},{1000 * r:.0f},15"),
        {"columns": "time_s,angle_deg,range_mm,-"}),
    "decimal commas": (
        "sep=;\nWinkel;Abstand\n" + lines(lambda k, a, r: f"{a:.1f};{1000 * r:.0f}", ","),
        {"columns": "angle_deg,range_mm"}),
    "dates": ("time;theta;r\n" + lines(
        lambda k, a, r: f"2020-09-13T12:26:40.{2 * k}+00:00;{a};{1000 * r:.0f}"),
        {"columns": "time,angle_deg,range_mm"}),
    "x and y": ("x_value,y_value,turn\n" + lines(xy), {"columns": "x_m,y_m,scan"}),
    "feet in radians": (
        lines(lambda k, a, r: f"{np.radians(a):.5f} {r / 0.3048:.5f}"),
        {"columns": "angle_rad,range_ft"}),
    "angles as head": (
        wide(["time", *(f"{a:.0f}" for a in TURN)]),
        {"columns": "time_s,ranges_m", "view": (0, 330)}),
    "a class at the end": (
        wide([], scale=1000, mark=";", end=["wall"]),
        {"columns": "time_s,ranges_mm,-", "view": (0, 330)}),
    "wheels before the ranges": (
        wide([], lambda k: [str(200000 * k), *"0" * 23], scale=1000, mark=" ", end=["0"]),
        {"columns": "time_us,-*23,ranges_mm,-", "view": (0, 330)}),
    "pose and scan": (
        wide([], lambda k: [f"{0.2 * k:.1f}", str(k), "0.5", "0.1"]),
        {"columns": "time_s,pose_x_m,pose_y_m,pose_theta_rad,ranges_m", "view": (0, 330)}),
    "pose and beam": (lines(
        lambda k, a, r: f"{0.2 * k:.1f},{k},0.5,0.1,{np.radians(a):.5f},{r:.3f}"),
        {"columns": "time_s,pose_x_m,pose_y_m,pose_theta_rad,angle_rad,range_m"}),
}  # fmt: skip
