"""Tables of one recording as programs and people write them: three scans of twelve beams."""

import json
import struct

import numpy as np
from log_samples import row, text

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


def pairs(mark, between):
    return between.join(f"{a:.0f}{mark}{r:.3f}" for a, r in zip(TURN, FAR, strict=True))


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


def message(k):
    """A LaserScan as JSON has it."""
    stamp = {"sec": 1600000000, "nanosec": 200000000 * k}
    numbers = dict(zip(KEYS, map(float, SINGLE), strict=True))
    ranges = {"ranges": FAR.tolist(), "intensities": []}
    return {"header": {"stamp": stamp, "frame_id": "laser"}, **numbers, **ranges}


def telegram(k, word="sSN"):
    """A scan of SICK from 0 degrees, whose counts begin at the right; a channel after it."""
    data = " ".join(f"{round(1000 * r):X}" for r in FAR)
    head = f"{word} LMDscandata 1 1 8D4C04 0 0 45FF 37 {200000 * k:X} 28A73 0 0 7 0 0 1388 168 0"
    channel = f"DIST1 3F800000 00000000 DBBA0 493E0 C {data}"
    return f"{head} 1 {channel} 1 RSSI1 3F800000 00000000 DBBA0 493E0 2 FE FE 0 0 0 0 0"


def urg_benri(k):
    ranges = ";".join(f"{1000 * r:.0f}" for r in FAR)
    return ["[timestamp]", str(200 * k), "[logtime]", "2012:01:01:12:00:00:000", "[scan]", ranges]


def ld19(k):
    """The twelve beams as a packet of an LD19, whose sum is that of its data sheet."""
    beams = b"".join(struct.pack("<HB", round(1000 * r), 200) for r in FAR)
    body = struct.pack("<BBHH", 0x54, 0x2C, 3600, 0) + beams + struct.pack("<HH", 33000, 200 * k)
    checksum = 0
    for bit in np.unpackbits(np.frombuffer(body, np.uint8)):
        checksum = ((checksum << 1) & 0xFF) ^ (0x4D if (checksum >> 7) ^ bit else 0)
    return body + bytes([checksum])


def flow(value):
    """A message in the flow style of YAML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {flow(v)}" for k, v in value.items()) + "}"
    return str(value)


def gazebo(k):
    stamp = ["  stamp {", "    sec: 1600000000", f"    nsec: {200000000 * k}", "  }"]
    ranges = [f"ranges: {r:.3f}" for r in FAR]
    view = ["angle_min: 0", "angle_max: 5.759587", "angle_step: 0.523599", "count: 12"]
    more = ["range_min: 0.05", "range_max: 12", *ranges, *["intensities: 0"] * 12]
    return ["header {", *stamp, "}", 'frame: "laser"', *view, *more, ""]


#: Name -> the text, whether angles grow clockwise, and its times: of CLOCK, from zero, or none.
OTHERS = {
    "ultra_simple": (
        lines(lambda k, a, r: (
            f"{'S' if a == 0 else ' '}  theta: {a:06.2f} Dist: {1000 * r:08.2f} Q: 47")),
        True, None),
    "ultra_simple, counted": (
        lines(lambda k, a, r: f"theta: {a:06.2f} Dist: {1000 * r:08.2f} Q: 47 Count: {a / 30:.0f}"),
        True, None),
    "gon and feet": ("time_us,theta_gon,range_ft,snr\n" + lines(lambda k, a, r: (
        f"{200000 * k},{a / 0.9:.4f},{r / 0.3048:.4f},9")), False, "zero"),
    "hundredths": ("packet;angle_cdeg;distance_mm\n" + lines(lambda k, a, r: (
        f"{k};{100 * a:.0f};{1000 * r:.0f}")), False, None),
    "Italian": ("Tempo (ms);Angolo (gradi);Distanza (cm)\n" + lines(lambda k, a, r: (
        f"{200 * k};{a:.1f};{100 * r:.1f}"), ","), False, "zero"),
    "Spanish": ("Tiempo (ms)\t\u00c1ngulo (grados)\tDistancia (mil\u00edmetros)\n"
        + lines(lambda k, a, r: f"{200 * k}\t{a:.0f}\t{1000 * r:.0f}"), False, "zero"),
    "from the middle of the angles": ("time_s,beam_angle_deg,measured range [m]\n" + text(
        f"{0.2 * k:.1f},{a if a <= 180 else a - 360:.0f},{r:.3f}" for k in range(3)
        for a, r in zip(np.roll(TURN, 3), np.roll(FAR, 3), strict=True)), False, "zero"),
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
    "JSON over lines": (json.dumps([message(k) for k in range(3)], indent=2), False, "clock"),
    "JSON one after the other": (
        text(json.dumps(message(k), indent=4) for k in range(3)), False, "clock"),
    "JSON of scans in lines": (
        text(json.dumps({"msg": message(k)}) for k in range(3)), False, "clock"),
    "JSON of rplidar": (json.dumps({"data": [SHOT] * 3}, indent=2), True, None),
    "JSON of scans of beams": (
        json.dumps({"device": "A1", "scans": [
            {"timestamp": CLOCK[k], "points": [
                {"angle": a, "distance": 1000 * r} for _, a, r in BEAMS[:12]]}
            for k in range(3)]}, indent=1), False, "clock"),
    "JSON of beams over lines": (
        json.dumps([{"angle_deg": a, "range_m": r} for _, a, r in BEAMS], indent=2), False, None),
    "JSON of arrays": (
        json.dumps({"times_s": [0, 0.2, 0.4], "angles_deg": TURN.tolist(),
                    "ranges": [FAR.tolist()] * 3}, indent=2), False, "zero"),
    "JSON with lists in each scan": (
        json.dumps([{"t": 0.2 * k, "angles": TURN.tolist(), "ranges_mm": (1000 * FAR).tolist()}
                    for k in range(3)]), False, "zero"),
    "telegrams": (text(telegram(k) for k in range(3)), False, "zero"),
    "telegrams as they are sent": (
        "".join(f"\x02{telegram(k, 'sRA')}\x03" for k in range(3)), False, "zero"),
    "telegrams in a diary": (
        text(f"10:00:0{k} got: {telegram(k)}" for k in range(3)), False, "zero"),
    "UrgBenri": (
        text(["[totalSteps]", "12", "[frontStep]", "2", "[startStep]", "2",
              *(line for k in range(3) for line in urg_benri(k))]), False, "zero"),
    "flow style": (text(f"{flow(message(k))}\n---" for k in range(3)), False, "clock"),
    "gz topic": (text(line for k in range(3) for line in gazebo(k)), False, "clock"),
    "printed by the node of rplidar": (
        text(line for k in range(3) for line in [
            "[ INFO] [1600000000.1]: I heard a laser scan laser[12]:",
            "[ INFO] [1600000000.1]: angle_range, 0.0, 330.0",
            *(f"[ INFO] [1600000000.1]: : [{a:f}, {r:f}]" for _, a, r in BEAMS[:12])]),
        False, None),
    "matrices of Octave": (
        text(["# Created by Octave 8.4.0", "# name: angles", "# type: matrix", "# rows: 1",
              "# columns: 12", row(np.radians(TURN)), "", "# name: ranges", "# type: matrix",
              "# rows: 3", "# columns: 12", *[row(FAR)] * 3]), False, None),
    "columns of Octave": (
        text(line for name, values in (("t", [k * 0.2 for k, *_ in BEAMS]),
                                       ("angle_deg", [a for _, a, _ in BEAMS]),
                                       ("range_m", [r for *_, r in BEAMS]))
             for line in [f"# name: {name}", "# type: matrix", *map(str, values)]), False, "zero"),
    "a radar on a servo": (
        "".join(f"{a:.0f},{100 * r:.0f}." for _, a, r in BEAMS), False, None),
    "XML": ("<scans>\n" + lines(
        lambda k, a, r: f'  <beam scan="{k}" angle="{a}" range_mm="{1000 * r:.0f}"/>')
        + "</scans>\n", False, None),
    "PCD": ("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 36\nDATA ascii\n" + lines(
        lambda k, a, r: f"{r * np.cos(np.radians(a)):.5f} {r * np.sin(np.radians(a)):.5f} 0"),
        False, None),
    "names of angles": (wide(["time_s", *(f"angle_{a:.0f}" for a in TURN)]), False, "zero"),
    "units as labels": (lines(lambda k, a, r: f"deg: {a} m: {r:.3f}"), False, None),
    "labels of nobody": (lines(lambda k, a, r: f"a: {a} d: {1000 * r:.0f}"), False, None),
    "labels of a program in other units": (
        lines(lambda k, a, r: f"theta: {np.radians(a):.5f} Dist: {r:.4f} Q: 47"), True, None),
    "a label a line": (
        lines(lambda k, a, r: f"Angle: {a:.0f}\nDistance: {100 * r:.0f} cm"), False, None),
    "units above": ("s;deg;mm\nTime;Angle;Distance\n" + lines(
        lambda k, a, r: f"{0.2 * k};{a};{1000 * r:.0f}"), False, "zero"),
    "types below units": ("Angle;Distance\ndeg;mm\nf8;f8\n" + lines(
        lambda k, a, r: f"{a};{1000 * r:.0f}"), False, None),
    "another mark of comments": ("; a note\n; angle_deg range_m\n" + lines(
        lambda k, a, r: f"{a} {r:.3f}"), False, None),
    "words without a colon": (
        lines(lambda k, a, r: f"Angle {a:.0f} Distance {1000 * r:.0f}"), False, None),
    "whole degrees and metres": (lines(lambda k, a, r: f"{a:.0f} {r:.3f}"), False, None),
    "empty columns": (lines(lambda k, a, r: f";{a:.0f};{1000 * r:.0f};"), False, None),
    "sync flags": (lines(
        lambda k, a, r: f"{'S' if a == 0 else ' '} {a:.2f} {1000 * r:.2f} 47"), True, None),
    "hexadecimal numbers": ("angle_deg,range_mm\n" + lines(
        lambda k, a, r: f"0x{int(a):04X},0x{round(1000 * r):04X}"), False, None),
    "days before months": ("time,angle_deg,range_m\n" + lines(
        lambda k, a, r: f"13/09/2020 {DAY.format(2 * k)[11:]},{a},{r:.3f}"), False, "clock"),
    "clock without names": (
        lines(lambda k, a, r: f"00:00:00.{2 * k},{a},{1000 * r:.0f}"), False, "zero"),
    "bytes printed": (
        lines(lambda k, a, r: f"b'{a:.0f},{1000 * r:.0f}\\r\\n'"), False, None),
    "dictionaries printed": (
        text(str({int(a): round(1000 * r) for _, a, r in BEAMS[:12]}) for _ in range(3)),
        False, None),
    "an array printed": (
        text(str(np.column_stack([TURN, 1000 * FAR])) for _ in range(3)), False, None),
    "YAML": (text(
        f"- t: {0.2 * k}\n  ranges: {FAR.tolist()}\n  angles: {np.radians(TURN).tolist()}"
        for k in range(3)), False, "zero"),
    "documents of YAML": (
        text(f"---\nstamp: {0.2 * k}\nranges:\n" + text(f"- {r}" for r in FAR) for k in range(3)),
        False, "zero"),
    "beams of YAML": (
        lines(lambda k, a, r: f"- angle_deg: {a}\n  range_mm: {1000 * r:.0f}"), False, None),
    "flow style in a list": (
        text(f"- {{t: {0.2 * k}, angles_deg: {TURN.tolist()}, ranges_m: {FAR.tolist()}}}"
             for k in range(3)), False, "zero"),
    "packets of an LD19": (text(ld19(k).hex(" ") for k in range(3)), True, "zero"),
    "packets as C has them": (
        text(", ".join(f"0x{byte:02X}" for byte in ld19(k)) for k in range(3)), True, "zero"),
    "directions with decimal commas": (
        wide(["t", *(f"{a:.1f}°" for a in TURN)], mark=";").replace(".", ","), False, "zero"),
    "units behind numbers in names": (
        wide(["t[ms]", *(f"r{k}[mm]" for k in range(12))], lambda k: [str(200 * k)], 1000),
        False, "zero"),
    "bagpy": (
        wide(["Time", "header.seq", "header.stamp.secs", "header.stamp.nsecs", "header.frame_id",
              *KEYS, *(f"ranges_{k}" for k in range(12))],
             lambda k: [f"{CLOCK[k] + 0.01:.2f}", str(k), "1600000000", str(200000000 * k), "laser",
                        *SINGLE]), False, "clock"),
    "units in the fields": (
        lines(lambda k, a, r: f"{a:.1f}deg,{1000 * r:.0f}mm"), False, None),
    "other units than the head": ("scan,angle_deg,range_mm\n" + lines(
        lambda k, a, r: f"{k},{np.radians(a):.5f} rad,{r:.3f} m"), False, None),
    "units behind white space": (
        lines(lambda k, a, r: f"{0.2 * k:.1f} s {a:.0f} deg {100 * r:.1f} cm"), False, "zero"),
    "units that change": ("Winkel;Abstand\n" + lines(
        lambda k, a, r: f"{a:.0f}°;{f'{1000 * r:.0f} mm' if r < 3 else f'{r:.3f} m'}", ","),
        False, None),
    "units in a scan a line": (
        text(["t;ranges", *("; ".join([f"{200 * k}ms", *(f"{1000 * r:.0f}mm" for r in FAR)])
                            for k in range(3))]), False, "zero"),
    "pairs behind a time": (
        text(f"{0.2 * k:.1f};" + pairs(",", ",") for k in range(3)), False, "zero"),
    "pairs under a short head": (
        text(["t;angle_deg,range_m,...", *(
            f"{0.2 * k:.1f};" + pairs(",", ";")
            for k in range(3))]), False, "zero"),
    "pairs with colons": (
        text(f"{0.2 * k:.1f} " + pairs(":", " ")
             for k in range(3)), False, "zero"),
    "a time before a colon": (
        text(f"{0.2 * k:.1f}: " + ", ".join(f"{r:.3f}" for r in FAR) for k in range(3)),
        False, "zero"),
    "a time before a bar": (
        text(f"{0.2 * k:.1f} | " + " ".join(f"{r:.3f}" for r in FAR) for k in range(3)),
        False, "zero"),
    "one name for all ranges": (
        text(["time_s,ranges_mm", *(f"{0.2 * k:.1f}," + ",".join(f"{1000 * r:.0f}" for r in FAR)
                                    for k in range(3))]), False, "zero"),
    "a stamp of the serial monitor": (
        "12:26:40.000 -> angle_deg,range_mm\n" + lines(
            lambda k, a, r: f"00:00:00.{200 * k:03d} -> {a:.0f},{1000 * r:.0f}"), False, "zero"),
    "a stamp of Python's logging": (
        text(line for k in range(3) for line in [
            f"2020-09-13 12:26:40,{200 * k:03d} INFO BEGIN Full rotation of the lidar",
            *(f"2020-09-13 12:26:40,{200 * k:03d} INFO {a}, {1000 * r:.1f}"
              for _, a, r in BEAMS[:12])]), False, "clock"),
    "a stamp of glog": (
        lines(lambda k, a, r: f"I0913 00:00:00.{200 * k:03d}000  2143 grab.cc:52] "
              f"deg: {a} m: {r:.3f}"), False, "zero"),
    "a stamp between scans": (
        text(line for k in range(3) for line in [
            f"Scan received[ {int(CLOCK[k] * 1000)}000000 ]: 12 ranges is [ 5.0 ]Hz",
            *(f"angle: {np.radians(a):.6f} range: {r:.4f}" for _, a, r in BEAMS[:12])]),
        False, "clock"),
    "a label between scans": (
        text(line for k in range(3) for line in [
            f"Speed: 10.0 RPM | Timestamp: {200 * k} ms",
            *(f"Angle: {a}\u00b0 | Distance: {1000 * r:.0f} mm" for _, a, r in BEAMS[:12])]),
        False, "zero"),
    "times in other languages": ("Temps (s);Angle;Distance\n" + lines(
        lambda k, a, r: f"{0.2 * k:.1f};{a};{1000 * r:.0f}"), False, "zero"),
    "a stamp of two words": ("header_stamp,angle_deg,range_m\n" + lines(
        lambda k, a, r: f"{CLOCK[k]:.3f},{a},{r:.3f}"), False, "clock"),
    "an array printed in a cell": (
        text(["header_stamp,angle_min,angle_max,angle_increment,ranges",
              *(f'{CLOCK[k]:.3f},{",".join(SINGLE[:3])},"array(\'f\', {FAR.round(3).tolist()})"'
                for k in range(3))]), False, "clock"),
    "UrgBenri without its head": (
        text(line for k in range(3) for line in [
            "[timestamp]", str(200 * k), "[scan]", ";".join(f"{1000 * r:.0f}" for r in FAR)]),
        False, "zero"),
    "words between scans": (
        text(line for k in range(3) for line in [
            "LIDAR Scan Results (Total: 12 readings)", "-" * 30, "Angle (deg)  Distance (m)",
            "-" * 30, *(f"{a:10.2f} {r:12.3f}" for _, a, r in BEAMS[:12])]), False, None),
}  # fmt: skip
