"""Tables of one recording as programs and people write them: three scans of twelve beams."""

import json

import numpy as np
from log_samples import text

#: Three scans of twelve beams.
TURN = np.arange(0, 360.0, 30)
FAR = 2 + 0.21 * np.arange(12)
BEAMS = [(k, a, r) for k in range(3) for a, r in zip(TURN, FAR, strict=True)]
#: The beams of one scan as the package rplidar has them.
SHOT = [(15, float(a), float(1000 * r)) for _, a, r in BEAMS[:12]]
#: Times of the scans, where a table has them.
CLOCK = 1.6e9 + 0.2 * np.arange(3)
DAY = "2020-09-13 12:26:40.{}"


def lines(line, mark=None):
    """A line a beam, of the scan k, the angle a in degrees, r in metres."""
    found = [line(k, a, r) for k, a, r in BEAMS]
    return text(found if mark is None else [f.replace(".", mark) for f in found])


def xv11(k):
    beams = [f"{a:.0f},{1000 * r:.0f},15,0" for a, r in zip(TURN, FAR, strict=True)]
    return ["AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", *beams, "ROTATION_SPEED,5.01"]


def wide(names, begin=lambda k: [f"{0.2 * k:.1f}"], scale=1.0, mark=","):
    ranges = [f"{scale * r:.3f}" if scale == 1 else f"{scale * r:.0f}" for r in FAR]
    return text([mark.join(names), *(mark.join([*begin(k), *ranges]) for k in range(3))])


SINGLE = ["0.0", "5.759587", "0.523599", "0.0", "0.1", "0.05", "12.0"]
KEYS = [
    *("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"),
    *("range_min", "range_max"),
]


def echo(stamp, ranges):
    said = [f"{key}: {value}" for key, value in zip(KEYS, SINGLE, strict=True)]
    return text(
        line
        for k in range(3)
        for line in ["header:", "  seq: 4", *stamp(k), "  frame_id: laser", *said, *ranges, "---"]
    )


def secs(k):
    return ["  stamp:", "    secs: 1600000000", f"    nsecs: {200000000 * k}"]


#: Name -> the text, whether angles grow clockwise, and its times: of CLOCK, from zero, or none.
OTHERS = {
    "ultra_simple": (
        lines(lambda k, a, r: (
            f"{'S' if a == 0 else ' '}  theta: {a:06.2f} Dist: {1000 * r:08.2f} Q: 47")),
        True, None),
    "record_measurments": (lines(lambda k, a, r: f"{a == 0}\t15\t{a}\t{1000 * r:.1f}"), True, None),
    "measures printed": (lines(lambda k, a, r: f"({a == 0}, 15, {a}, {1000 * r:.1f})"), True, None),
    "scans printed": (
        text(str([(15, float(a), float(1000 * r)) for _, a, r in BEAMS[:12]]) for k in range(3)),
        True, None),
    "xv11": (text(line for k in range(3) for line in xv11(k)), False, None),
    "ld19": (lines(lambda k, a, r: f"angle:{a:.2f},distance(mm):{1000 * r:.0f},intensity:200"),
        True, None),
    "ydlidar": ("angle,range,intensity\n" + lines(
        lambda k, a, r: f"{np.radians(a):.5f},{r:.3f},10"), False, None),
    "stamped text": ("Timestamp,Angle,Distance\n" + lines(
        lambda k, a, r: f"{DAY.format(2 * k)},{a:.0f},{1000 * r:.0f}"), False, "clock"),
    "iso": ("time;theta;r\n" + lines(
        lambda k, a, r: f"2020-09-13T12:26:40.{2 * k}+00:00;{a};{1000 * r:.0f}"), False, "clock"),
    "time of day": ("time angle_deg dist_m\n" + lines(
        lambda k, a, r: f"00:00:00.{2 * k} {a} {r:.3f}"), False, "zero"),
    "milliseconds": ("timestamp\tangle_deg\tdistance_cm\n" + lines(
        lambda k, a, r: f"{200 * k}\t{a}\t{100 * r:.1f}"), False, "zero"),
    "since 1970": ("stamp,angle_deg,range_m\n" + lines(
        lambda k, a, r: f"{int(CLOCK[k] * 1000)},{a},{r:.3f}"), False, "clock"),
    "newscan": ("newscan,quality,angle,distance\n" + lines(
        lambda k, a, r: f"{int(a == 0)},15,{a},{1000 * r:.2f}"), True, None),
    "x and y": ("x_value,y_value,scan\n" + lines(
        lambda k, a, r: f"{r * np.cos(np.radians(a)):.5f},{r * np.sin(np.radians(a)):.5f},{k}"),
        False, None),
    "feet": ("id,angle [deg],range [ft],weather\n" + lines(
        lambda k, a, r: f"{k},{a},{r / 0.3048:.5f},rain"), False, None),
    "decimal commas": ("sep=;\nAngle;Distance\n" + lines(
        lambda k, a, r: f"{a:.1f};{1000 * r:.0f}", ","), False, None),
    "no names": (lines(lambda k, a, r: f"{0.2 * k:.1f},{a:.2f},{1000 * r:.0f},15"), False, "zero"),
    "no names, radians": (lines(lambda k, a, r: f"{np.radians(a):.5f} {r:.3f}"), False, None),
    "notes first": ("# recorded in the lab\nModel: A1\n\nangle_deg,range_mm\n" + lines(
        lambda k, a, r: f"{a},{1000 * r:.0f}"), False, None),
    "angles as head": (wide(["time", *(f"{a:.0f}" for a in TURN)]), False, "zero"),
    "radians as head": (
        wide(["t_s", *(f"{a:.5f}" for a in np.radians(TURN))], mark=";"), False, "zero"),
    "index as head": (
        wide(["time_s", *(f"range_mm_{k}" for k in range(12))], scale=1000, mark="\t"),
        False, "zero"),
    "rostopic -p": (
        wide(["%time", *(f"field.{key}" for key in KEYS), *(f"field.ranges{k}" for k in range(12))],
             lambda k: [str(1600000000000000000 + 200000000 * k), *SINGLE]), False, "clock"),
    "ros2 --csv": (
        text(",".join(["1600000000", str(200000000 * k), "laser", *SINGLE,
                       *(f"{r:.3f}" for r in FAR), *["0.0"] * 12]) for k in range(3)),
        False, "clock"),
    "rostopic -p without its head": (
        text(",".join([str(1600000000000000000 + 200000000 * k)] * 1 + [
            "7", str(1600000000000000000 + 200000000 * k), "laser", *SINGLE,
            *(f"{r:.3f}" for r in FAR)]) for k in range(3)),
        False, "clock"),
    "rostopic echo": (
        echo(secs, [f"ranges: {[round(float(r), 3) for r in FAR]}"]), False, "clock"),
    "ros2 topic echo": (
        echo(lambda k: ["  stamp:", "    sec: 1600000000", f"    nanosec: {200000000 * k}"],
             ["ranges:", *(f"- {r:.3f}" for r in FAR), "intensities:", *["- .nan"] * 12]),
        False, "clock"),
    "scans printed with their number": (
        text(f"{k}: Got 12 measurments\n{k}: {SHOT}" for k in range(3)), True, None),
    "scans printed as lists": (text(json.dumps(SHOT) for _ in range(3)), True, None),
    "beams printed": (lines(lambda k, a, r: f"(15, {a}, {1000 * r:.1f})"), True, None),
    "a JSON a line": (
        lines(lambda k, a, r: json.dumps({"angle_deg": a, "range_mm": 1000 * r, "scan": k})),
        False, None),
    "one line of JSON": (
        json.dumps([{"angle_deg": a, "range_m": r} for _, a, r in BEAMS]) + "\n", False, None),
    "units behind numbers": (
        lines(lambda k, a, r: f"Angle: {a:.2f} deg, Distance: {r / 0.3048:.4f} ft"), False, None),
    "xv11 as it is sent": (
        "\x1a".join("getldsscan\r\n" + "\r\n".join(xv11(k)) + "\r\n" for k in range(3)) + "\x1a",
        False, None),
    "ld19 with units behind": (
        lines(lambda k, a, r: f"stamp:{int(1e9 * CLOCK[k])}(ns),angle:{a}(deg),distance:{r}(m)"),
        False, "clock"),
    "pandas, tabs": ("\tangle\tdistance\n" + "".join(
        f"{i}\t{a}\t{1000 * r:.1f}\n" for i, (_, a, r) in enumerate(BEAMS)), False, None),
    "commas in quotes": ('angle,distance,"scan"\n' + lines(
        lambda k, a, r: f'"{a:.1f}"*"{1000 * r:.1f}"*{k}', ",").replace("*", ","), False, None),
    "text in quotes": ("place,angle_deg,range_mm\n" + lines(
        lambda k, a, r: f'"lab, east",{a},{1000 * r:.0f}'), False, None),
    "thousands": ("Angle;Distance (mm)\n" + lines(
        lambda k, a, r: f"{a:.1f};{r:.3f},0".replace(";", ",0;", 1).replace(".0,0", ",0")),
        False, None),
    "head in line 4": ("Lab 3\nSensor,A1M8\nRPM,330\nAngle[deg],dist (cm),quality\n" + lines(
        lambda k, a, r: f"{a},{100 * r:.1f},15"), False, None),
    "units below the head": ("angle;distance;time\n[deg];[cm];[ms]\n" + lines(
        lambda k, a, r: f"{a};{100 * r:.1f};{200 * k}"), False, "zero"),
    "percent": ("% angle_rad range_m\n" + lines(
        lambda k, a, r: f"{np.radians(a):.5f} {r:.3f}"), False, None),
    "slashes": ("// dump\n// angle distance\n" + lines(
        lambda k, a, r: f"{a} {1000 * r:.0f}"), False, None),
    "bars": ("angle|distance\n" + lines(lambda k, a, r: f"{a}|{1000 * r:.0f}"), False, None),
    "lines of old Macs": (("angle_deg,range_mm\n" + lines(
        lambda k, a, r: f"{a},{1000 * r:.0f}")).replace("\n", "\r"), False, None),
    "date of Germany": ("time;angle;distance\n" + lines(
        lambda k, a, r: f"13.09.2020 12:26:40,{2 * k};{a};{1000 * r:.0f}"), False, "clock"),
    "date of the US": ("Time,Angle,Distance\n" + lines(
        lambda k, a, r: f"9/13/2020 12:26:40.{2 * k} PM,{a},{1000 * r:.0f}"), False, "clock"),
    "a zone": ("Timestamp,Angle,Distance\n" + lines(
        lambda k, a, r: f"2020-09-13T14:26:40.{2 * k}+02:00,{a},{1000 * r:.0f}"), False, "clock"),
    "of an Arduino": ("micros,angle,dist_in\n" + lines(
        lambda k, a, r: f"{200000 * k},{a},{r / 0.0254:.3f}"), False, "zero"),
    "ticks": ("step_1024 angle_ticks1440 range_m\n" + lines(
        lambda k, a, r: f"7 {4 * a:.0f} {r:.3f}"), False, None),
    "pose and beam": ("t,x,y,theta,angle,range\n" + lines(
        lambda k, a, r: f"{0.2 * k:.1f},{k},0.5,0.1,{np.radians(a):.5f},{r:.3f}"), False, "zero"),
    "points from zero": ("X(mm),Y(mm)\n" + lines(lambda k, a, r: (
        f"{1000 * r * np.cos(np.radians(a)):.1f},{1000 * r * np.sin(np.radians(a)):.1f}")),
        False, None),
    "numbers of scans": (lines(lambda k, a, r: f"{k:.18e} {a:.18e} {1000 * r:.18e}"), False, None),
    "plotjuggler": (
        wide(["__time", *(f"/scan/{key}" for key in KEYS),
              *(f"/scan/ranges[{k}]" for k in range(12))],
             lambda k: [f"{CLOCK[k]:.3f}", *SINGLE]), False, "clock"),
    "ranges in one cell": (
        text(["Time,angle_min,angle_max,angle_increment,ranges",
              *(f'{CLOCK[k]:.3f},{",".join(SINGLE[:3])},"{tuple(FAR.round(3).tolist())}"'
                for k in range(3))]), False, "clock"),
    "numbers between scans": (
        text(line for k in range(3) for line in [
            f"Scan {k}:", *(f"{a} {1000 * r:.0f}" for _, a, r in BEAMS[:12])]), False, None),
    "thousands of the US": ("angle,range_mm\n" + lines(
        lambda k, a, r: f'{a},"{1000 * r:,.0f}"'), False, None),
    "thousands of France": ("angle (degr\u00e9s);distance (mm)\n" + lines(
        lambda k, a, r: f"{a};{1000 * r:,.1f}".replace(",", "\u00a0").replace(".", ",")),
        False, None),
    "midnight in between": ("time,angle_deg,range_m\n" + lines(
        lambda k, a, r: f"{'23:59:59.8' if k == 0 else f'00:00:00.{2 * k - 2}'},{a},{r:.3f}"),
        False, "midnight"),
    "days of Excel": ("time,angle_deg,range_m\n" + lines(
        lambda k, a, r: f"{45000 + 0.2 * k / 86400:.9f},{a},{r:.3f}"), False, "excel"),
    "other words, known units": ("Winkel (deg);Abstand (ft)\n" + lines(
        lambda k, a, r: f"{a};{r / 0.3048:.4f}"), False, None),
    "short names": (
        text(["t," + ",".join(f"a{k},d{k}" for k in range(12)), *(
            f"{0.2 * k:.1f}," + ",".join(f"{a},{r:.3f}" for _, a, r in BEAMS[:12])
            for k in range(3))]), False, "zero"),
    "angles in each line": (
        text([",".join(f"angle_{k},range_{k}" for k in range(12)),
              *[",".join(f"{a},{r:.3f}" for _, a, r in BEAMS[:12])] * 3]), False, None),
    "pose and scan": (
        wide(["t", "x", "y", "theta", *(f"r{k}" for k in range(12))],
             lambda k: [f"{0.2 * k:.1f}", f"{k}", "0.5", "0.1"]), False, "zero"),
}  # fmt: skip
