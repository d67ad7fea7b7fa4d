"""The moving picture of the README: a real log from raw odometry to a map, as a GIF.

Run it by `.venv/bin/python notebooks/tools/intel_picture.py intel.log.gz`. The log may not be
distributed: `data/records/README.md` tells where it comes from.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

import segmap
from segmap.plotting import ERROR, MAP, RAW, RESULT
from segmap.poses import transform

TARGET = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "intel.gif"
INCHES, DPI = (5.6, 4.8), 100
#: While segments move, those of every eighth scan are drawn.
EVERY = 8
DRIVE_FRAMES, BEND_FRAMES = 12, 12
#: How long frames stay: one of many, the last of a stage, the map at the end.
FRAME_MS, STAGE_MS, MAP_MS = 180, 1500, 4000
#: Enough for thin lines in grey, blue and orange.
COLOURS = 8
CREDIT = "Log: Intel Research Lab, Seattle, recorded by Dirk Hähnel"


class Drawn(NamedTuple):
    """What one frame shows, and for how long, in milliseconds."""

    title: str
    walls: NDArray[np.float64]
    path: NDArray[np.float64]
    colour: str
    box: NDArray[np.float64]
    stays: int


def main(path: str) -> None:
    """Align and reduce the log of a file, and store how that looks."""
    log = segmap.alignment.prepared(segmap.read(path))
    alignment = segmap.alignment.pose_graph(log)
    walls = segmap.build_map(log, alignment.poses)
    alignment = alignment.turned(-segmap.segments.main_direction(walls))
    full = segmap.build_map(log, alignment.poses)
    small = segmap.reduction.least_cost(full, penalty=0.28)
    stages = list(drive_and_bend(log, alignment.poses))
    title = f"least_cost: the {len(full)} segments of all scans become {len(small)}"
    nowhere = alignment.poses[:0, :2]
    # The map comes first, for viewers that show one frame.
    frames = [Drawn(title, small.segments, nowhere, MAP, stages[-1].box, MAP_MS), *stages]
    pictures = [picture(frame) for frame in frames]
    chosen = np.vstack([pictures[k] for k in (0, DRIVE_FRAMES, -1)])
    palette = Image.fromarray(chosen).quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
    first, *others = [p.quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures]
    stays = [frame.stays for frame in frames]
    first.save(TARGET, save_all=True, append_images=others, duration=stays, loop=0, optimize=True)
    print(f"{TARGET.name}: {len(frames)} frames, {TARGET.stat().st_size / 1000:.0f} kB")


def drive_and_bend(log: segmap.Log, poses: NDArray[np.float64]) -> Iterator[Drawn]:
    """The scans where the odometry lays them, as they come; then how loops pull them into place."""
    seen = {k: segmap.extract_polylines(log[k].points()) for k in range(0, len(log), EVERY)}

    def walls(poses: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([transform(poses[k], s) for k, s in seen.items() if k < len(poses)])

    begin, end = (box_around(walls(p)) for p in (log.odometry, poses))
    for scans in np.linspace(0, len(log), DRIVE_FRAMES + 1).astype(int)[1:]:
        part = log.odometry[:scans]
        stays = STAGE_MS if scans == len(log) else FRAME_MS
        title = f"raw odometry: {scans} of {len(log)} scans"
        yield Drawn(title, walls(part), part[:, :2], ERROR, begin, stays)
    way = poses - log.odometry
    way[:, 2] = np.unwrap(way[:, 2])
    for share in (1 - np.cos(np.linspace(0, np.pi, BEND_FRAMES + 1)[1:])) / 2:
        part = log.odometry + share * way
        box = begin + share * (end - begin)
        stays = STAGE_MS if share == 1 else FRAME_MS
        title = "pose_graph: places that were seen twice close loops"
        yield Drawn(title, walls(part), part[:, :2], RESULT, box, stays)


def box_around(walls: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners `(2, 2)` of what is shown: a hundredth of the ends on each side may lie outside."""
    return np.percentile(walls.reshape(-1, 2), [1, 99], axis=0) + [[-2], [2]]


def picture(frame: Drawn) -> Image.Image:
    """One frame, pixel by pixel."""
    figure = Figure(figsize=INCHES, dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    ax = figure.add_axes((0, 0.06, 1, 0.86), aspect="equal")
    colour, width = (MAP, 1.2) if frame.colour == MAP else (RAW, 0.5)
    ax.add_collection(LineCollection(list(frame.walls), colors=colour, linewidths=width))
    ax.plot(*frame.path.T, color=frame.colour, linewidth=1)
    ax.set(xlim=frame.box[:, 0], ylim=frame.box[:, 1])
    ax.axis("off")
    figure.text(0.5, 0.95, frame.title, ha="center", va="center", fontsize=12)
    figure.text(0.5, 0.03, CREDIT, ha="center", va="center", fontsize=9)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])


if __name__ == "__main__":
    main(sys.argv[1])
