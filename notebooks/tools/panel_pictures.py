"""Pictures of panels for the book, where nothing moves: `make panels`.

Each chapter is run up to its panel, whose controls are then moved through the states below. What is
seen is stored under notebooks/pictures/panels: one file a panel, its states one below the other,
with what each state says of itself. One of the states is that with which the panel begins, so that
the book notices pictures that are older than the chapter.
"""

import base64
import copy
import io
import json
import sys
from pathlib import Path
from typing import Any

import nbformat
from nbformat import NotebookNode
from PIL import Image
from refresh import VIEW, execute

ROOT = Path(__file__).resolve().parents[2]
CHAPTERS = ROOT / "notebooks"
FOLDER = CHAPTERS / "pictures" / "panels"
#: The tag of a picture that holds a description.
DESCRIPTION = 0x010E
#: Pixels across, as a panel draws for fine screens.
WIDTH = 960
#: Colours of the palette: the fewer are taken where a file would be larger than this.
COLOURS, MOST_BYTES = (48, 24, 12), 40_000

#: Number of the chapter, and of the panel in it -> what is done before each picture.
STATES: dict[str, list[str]] = {
    "00-1": ["tolerance=0.01", "tolerance=0.04", "tolerance=0.10", "tolerance=0.20"],
    "11-1": ["", "step=20", "step=40", "step=60"],
    "12-1": ["", "step=16", "step=32", "step=48"],
    "13-1": ["", "noise=50", "beams=91", "noise=10, beams=682, turn=90"],
    "14-1": ["", "rate=20", "rate=5.5, turn=180", "deskewed=True"],
    "21-1": ["gap=0.05", "gap=0.30", "gap=1.0", "gap=0.30, fit='algebraic'"],
    "22-1": ["tolerance=0.005", "tolerance=0.03", "tolerance=0.10", "tolerance=0.5"],
    "23-1": ["", "method_name='EM'", "method_name='RANSAC'", "method_name='clusters'"],
    "31-1": ["", "every=4", "max_gap=3.0", "every=1, late=0.3"],
    "32-1": ["", "rank=1", "rank=2", "rank=3"],
    "32-2": ["", "x=0.6", "x=1.5", "distance=1.0"],
    "33-1": ["", "scan=40", "scan=53", "scan=53, min_length=2.0"],
    "34-1": ["", "step=3", "step=60", "x=1.5, y=1.5, turn=30, step=60"],
    "35-1": ["", "loops=False", "odometry=True", "loops=True"],
    "36-1": ["", "run(40)", "run(40)", "run(40)"],
    "37-1": ["", "scan=20", "off=-40", "off=-40, gate=0.5, scan=40"],
    "38-1": ["", "similar=0.05", "similar=0.60", "similar=0.20, spread=0.005"],
    "39-1": ["scan=60", "scan=100", "scan=210", "loops=False"],
    "40-1": ["", "x=1.0", "x=1.5, y=1.5", "x=0, y=0, turn=40"],
    "41-1": ["", "angle=30", "angle=0, offset=0.5", "offset=0, length=0.5"],
    "42-1": ["", "map='B'", "map='C'", "map='D', scan=12"],
    "50-1": ["", "noise='0.02'", "distance=0.02", "noise='0.03'"],
    "51-1": ["distance=0.05", "distance=0.2", "distance=0.4", "distance=0.4, angle=30"],
    "52-1": ["", "origin=-40", "origin=-100", "origin=0, distance=0.6"],
    "53-1": ["sigma=0.05", "sigma=0.2", "sigma=0.6", "sigma=1.0"],
    "54-1": ["tolerance=0.01", "tolerance=0.04", "tolerance=0.10", "tolerance=0.20"],
    "54-2": ["", "every=10", "every=1", "by='fusion_online'"],
    "55-1": ["by='segment_similarity'", "cost=0.1", "by='uncertain_parameters'", "distance=0.3"],
    "56-1": ["", "scan=33", "forget=False", "scan=50"],
    "57-1": ["place=0, heading=0", "place=0.03, heading=0.5", "place=0.1", "place=0.2, heading=3"],
    "58-1": ["penalty=0.005", "penalty=0.05", "penalty=0.2", "penalty=0.5"],
    "59-1": ["", "by='one_per_wall', noise='0.02'", "factor=0.4", "factor=4.0"],
    "60-1": ["", "wanted=60", "wanted=95", "method='basic_online', wanted=80"],
    "61-1": ["", "doublings=2", "scans=1, doublings=0", "scans=20"],
    "62-1": ["", "touched=True", "mask=False", "touched=False"],
    "63-1": ["", "turn=10", "score='occupancy', turn=0", "score='nearest'"],
    "64-1": ["", "step=5", "step=60", "matcher='sample and rank'"],
    "66-1": ["", "resolution=20.0", "resolution=1.0", "resolution=5.0, tolerance=20.0"],
    "67-1": ["", "scan=20", "scan=40", "carried=True, scan=30"],
    "68-1": ["", "scan=150", "scan=255", "scan=290"],
    "69-1": ["", "radius=0.35", "radius=0.5", "goal_x=6.0, goal_y=2.8, radius=0.1"],
    "70-1": ["", "kappa=0.1", "kappa=3.0", "kappa=1.25, band=0.02"],
    "71-1": ["", "run(20)", "run(20)", "run(20)"],
    "91-1": ["tolerance=0.01", "tolerance=0.05", "tolerance=0.2", "tolerance=0.4"],
    "92-1": ["", "occupied=0.9", "occupied=0.5, free=0.0", "free=0.25, doublings=2"],
    "93-1": ["", "method='basic_offline'", "wanted=90", "method='hybrid'"],
    "94-1": ["", "origin=-20", "origin=-50", "origin=-100"],
    "01-1": ["", "run()", "method='hybrid', run()", "method='fusion', run()"],
    "01-2": ["", "least=0.5, run()"],
    "01-3": ["", "method['tolerance']=0.1, run()"],
}

#: Run behind the cell that shows the panel: each state becomes an output.
MOVE = """
from IPython.display import display as _display
for _moves in {moves!r}:
    for _move in filter(None, _moves.split(", ")):
        _name, _, _value = _move.partition("=")
        if not _value:
            eval(f"{panel}.{{_name}}")
        elif "[" in _name:
            _name, _, _key = _name.partition("[")
            getattr({panel}, _name)[eval(_key[:-1])].value = eval(_value)
        else:
            getattr({panel}, _name).value = eval(_value)
    _shown = {panel}._repr_mimebundle_()
    if {panel}.picture.value:  # what a browser with a kernel is given is finer
        _shown["image/png"] = bytes({panel}.picture.value)
    _display({{k: _shown[k] for k in ("image/png", "text/plain")}}, raw=True)
"""


def shown(path: Path) -> dict[str, list[tuple[Image.Image, str]]]:
    """Name of each panel of a chapter -> picture and words of each of its states."""
    notebook = nbformat.read(path, as_version=4)
    panels = [k for k, cell in enumerate(notebook.cells) if shows_panel(cell)]
    return {
        f"{path.stem}-{number}": _states(path, notebook.cells[: k + 1], number)
        for number, k in enumerate(panels, 1)
    }


def shows_panel(cell: NotebookNode) -> bool:
    """Whether a cell of a chapter shows a panel."""
    return any(VIEW in output.get("data", {}) for output in cell.get("outputs", []))


def _states(path: Path, cells: list[NotebookNode], number: int) -> list[tuple[Image.Image, str]]:
    """Run cells, the last of which shows a panel, and move it."""
    moves = STATES.get(f"{path.stem[:2]}-{number}", [""])
    panel = cells[-1].source.strip().splitlines()[-1]
    moved = nbformat.v4.new_code_cell(MOVE.format(moves=moves, panel=panel))
    execute(nbformat.v4.new_notebook(cells=[*copy.deepcopy(cells), moved]), path.parent)
    return [_state(output) for output in moved.outputs]


def _state(output: Any) -> tuple[Image.Image, str]:
    picture = Image.open(io.BytesIO(base64.b64decode(output.data["image/png"])))
    said = output.data["text/plain"].removesuffix(")").partition("(")[2]
    return picture.convert("RGB"), said


def strip(pictures: list[Image.Image]) -> Image.Image:
    """Pictures one below the other, each in a frame as large as the largest."""
    width, height = (max(sides) for sides in zip(*(p.size for p in pictures), strict=True))
    whole = Image.new("RGB", (width, height * len(pictures)), "white")
    for k, picture in enumerate(pictures):
        whole.paste(picture, (0, k * height))
    scale = min(1.0, WIDTH / width)
    size = round(scale * width), round(scale * height) * len(pictures)
    return whole if scale == 1.0 else whole.resize(size, Image.Resampling.LANCZOS)


def packed(image: Image.Image, said: list[str]) -> bytes:
    """As a file, no larger than need be, that holds what each state says of itself."""
    method, kept, exif = Image.Quantize.MAXCOVERAGE, b"", Image.Exif()
    exif[DESCRIPTION] = json.dumps(said)
    for colours in COLOURS:
        target = io.BytesIO()
        few = image.quantize(colours, method=method, dither=Image.Dither.NONE).convert("RGB")
        few.save(target, "WEBP", lossless=True, method=6, exif=exif)
        kept = target.getvalue()
        if len(kept) <= MOST_BYTES:
            break
    return kept


def said_in(path: Path) -> list[str]:
    """What the states in a stored picture say of themselves."""
    with Image.open(path) as image:
        return list(json.loads(image.getexif()[DESCRIPTION]))


def store(path: Path) -> list[Path]:
    """Store the pictures of a chapter's panels; answers their files."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    files = []
    for name, states in shown(path).items():
        pictures, said = zip(*states, strict=True)
        files.append(FOLDER / f"{name}.webp")
        files[-1].write_bytes(packed(strip(list(pictures)), list(said)))
    return files


def main(paths: list[str]) -> int:
    """Store the pictures of some chapters, or of all; answers the number of those that failed."""
    failed = 0
    for path in map(Path, paths) if paths else sorted(CHAPTERS.glob("*.ipynb")):
        try:
            sizes = [f"{file.stat().st_size // 1000} KB" for file in store(path)]
            print(f"{path.name}: {', '.join(sizes) or 'no panel'}", flush=True)
        except Exception as problem:
            failed += 1
            print(f"{path.name}: left as it was\n{problem}", file=sys.stderr, flush=True)
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
