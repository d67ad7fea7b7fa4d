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
from segmap_course import FIGURE_MIME

ROOT = Path(__file__).resolve().parents[2]
CHAPTERS = ROOT / "notebooks"
FOLDER = CHAPTERS / "pictures" / "panels"
#: The tag of a picture that holds a description.
DESCRIPTION = 0x010E
#: Pixels across, as a panel draws for fine screens.
WIDTH = 720
#: A file of this format is no higher, pixels.
HIGHEST = 16_383
#: Colours of the palette: the fewer are taken where a file would be larger than this.
COLOURS, MOST_BYTES = (24, 12), 60_000

#: Number of the chapter, and of the panel in it -> what is done before each picture. `name=*` moves
#: a control from end to end: as many pictures as STEPS, and one of the value at first.
STATES: dict[str, list[str]] = {
    "01-1": ["tolerance=*"],
    "02-1": ["step=*"],
    "02-2": ["every=*"],
    "03-1": ["gap=*"],
    "04-1": ["tolerance=*"],
    "05-1": ["rank=*"],
    "05-2": ["x=*"],
    "08-1": ["x=*"],
    "09-1": ["scan=*"],
    "10-1": ["similar=*"],
    "11-1": ["scan=*"],
    "13-1": ["map=*"],
    "14-1": ["distance=*"],
    "15-1": ["origin=*"],
    "16-1": ["sigma=*"],
    "17-1": ["tolerance=*"],
    "18-1": ["distance=*"],
    "19-1": ["place=*"],
    "20-1": ["scan=*"],
    "21-1": ["penalty=*"],
    "22-1": ["", "factor=*"],
    "23-1": ["wanted=*"],
    "24-1": ["doublings=*"],
    "25-1": ["beams=*"],
    "26-1": ["", "score='distance', turn=*"],
    "27-1": ["step=*"],
    "28-1": ["", "do(plan.Join((8.2,0.8),(4.5,8.1)))"],
    "29-1": ["", *9 * ["run(10)"]],
    "51-1": ["", "run()", "method='hybrid', run()", "method='fusion', run()"],
    "51-2": ["", "least=0.5, run()"],
    "51-3": ["", "method['tolerance']=0.1, run()"],
    "52-1": ["step=*"],
    "53-1": ["noise=*"],
    "54-1": ["rate=*"],
    "55-1": ["method_name=*"],
    "56-1": ["", *9 * ["run(37)"]],
    "57-1": ["scan=*"],
    "58-1": ["", "resolution=20.0", "resolution=1.0", "resolution=5.0, tolerance=20.0"],
    "59-1": ["scan=*"],
    "60-1": ["scan=*"],
    "61-1": ["radius=*"],
    "62-1": ["occupied=*"],
    "91-1": ["tolerance=*"],
    "94-1": ["origin=*"],
}
#: Pictures of a control from its least to its greatest value.
STEPS = 9

#: Run behind the cell that shows the panel: each state becomes an output.
MOVE = """
from IPython.display import display as _display
_panel = {panel}
def _each(moves):
    first, _, name = moves.removesuffix("=*").rpartition(", ")
    control = getattr(_panel, name)
    if hasattr(control, "options"):
        values = [o[1] if isinstance(o, tuple) else o for o in control.options]
    else:
        reach = (control.max - control.min) / control.step
        even = [control.min + round(k * reach / {last}) * control.step for k in range({last} + 1)]
        values = sorted({{*(round(v, 6) for v in even), control.value}})
    return [", ".join(filter(None, [first, f"{{name}}={{v!r}}"])) for v in values]
_wanted = [n for m in {moves!r} for n in (_each(m) if m.endswith("=*") else [m])]
for _moves in _wanted:
    for _move in filter(None, _moves.split(", ")):
        _name, _, _value = _move.partition("=")
        if not _value:
            eval(f"_panel.{{_name}}")
        elif "[" in _name:
            _name, _, _key = _name.partition("[")
            getattr(_panel, _name)[eval(_key[:-1])].value = eval(_value)
        else:
            getattr(_panel, _name).value = eval(_value)
    _shown = _panel._repr_mimebundle_()
    if isinstance(_shown, tuple):  # of a widget that draws itself: with metadata
        _shown = _shown[0]
    elif hasattr(_panel, "picture") and _panel.picture.value:  # finer, for who has a kernel
        _shown["image/png"] = bytes(_panel.picture.value)
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
    """Whether a cell of a chapter shows a panel; a figure to drag is none, it lives in the book."""
    shown = [output.get("data", {}) for output in cell.get("outputs", [])]
    return any(VIEW in data and FIGURE_MIME not in data for data in shown)


def _states(path: Path, cells: list[NotebookNode], number: int) -> list[tuple[Image.Image, str]]:
    """Run cells, the last of which shows a panel, and move it."""
    moves = STATES.get(f"{path.stem.partition('_')[0]}-{number}", [""])
    panel = cells[-1].source.strip().splitlines()[-1]
    moved = nbformat.v4.new_code_cell(MOVE.format(moves=moves, panel=panel, last=STEPS - 1))
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
    scale = min(1.0, WIDTH / width, HIGHEST / height / len(pictures))
    size = round(scale * width), int(scale * height) * len(pictures)
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
