"""Run chapters again and store their outputs: `make refresh`.

A chapter is replaced only when it ran to its end, and only by what differs: cells are named by
their content, the metadata is fixed, and a picture with the same pixels stays as it was stored.
"""

import base64
import hashlib
import io
import os
import platform
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
from book.alt_texts import alt_text
from nbclient import NotebookClient
from nbformat import NotebookNode
from PIL import Image, ImageSequence
from PIL.Image import Resampling

VIEW = "application/vnd.jupyter.widget-view+json"
KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
#: What a kernel says of itself: where a chapter lacks it JupyterLab writes it in when it is opened.
LANGUAGE = {
    "codemirror_mode": {"name": "ipython", "version": 3},
    "file_extension": ".py",
    "mimetype": "text/x-python",
    "name": "python",
    "nbconvert_exporter": "python",
    "pygments_lexer": "ipython3",
    "version": platform.python_version(),
}
#: Of every picture the first of these that fits: parts of its width and height, and colours.
SIZES = (
    *((1.0, 128), (1.0, 32), (1.0, 24), (0.85, 24), (0.75, 24), (0.625, 24)),
    *((0.5, 48), (0.5, 24), (0.5, 12), (0.45, 12)),
)
#: What chapters may have, and a little room.
MOST_PICTURE_BYTES, MOST_CHAPTER_BYTES = 30_000, 198_000
#: The output of the cell with this tag is the picture in the README.
README_TAG = "readme-picture"
#: Cells with this tag only hold the text to what it says: JupyterLab shows them folded.
GUARD_TAG = "guard"
#: The output of a cell with this tag answers a prediction: JupyterLab shows it folded, until it
#: runs.
REVEAL_TAG = "reveal"
README_PICTURE = Path("pictures/malaga.png")


def execute(notebook: NotebookNode, folder: Path) -> NotebookNode:
    """Run all cells of a notebook, in place, in a fresh kernel that starts in a folder."""
    os.environ["PYTHONWARNINGS"] = "error::DeprecationWarning:__main__"
    where = {"metadata": {"path": str(folder)}}
    client = NotebookClient(
        notebook, timeout=120, record_timing=False, coalesce_streams=True, resources=where
    )
    return client.execute()


def tidy(notebook: NotebookNode) -> NotebookNode:
    """Drop, in place, what differs from run to run or from machine to machine."""
    notebook.metadata = NotebookNode(kernelspec=KERNEL, language_info=LANGUAGE)
    notebook.nbformat_minor = 5
    used: dict[str, int] = {}
    for cell in notebook.cells:
        tags = cell.metadata.get("tags")
        cell.metadata = NotebookNode({"tags": tags} if tags else {})
        if GUARD_TAG in (tags or []):
            cell.metadata["jupyter"] = {"source_hidden": True}
        if REVEAL_TAG in (tags or []):
            cell.metadata["jupyter"] = {"outputs_hidden": True}
        cell.id = _cell_id(cell, used)
    for number, output in enumerate(_outputs_with(notebook, VIEW)):
        output.data[VIEW]["model_id"] = f"{number:032x}"
    return notebook


def name_pictures(notebook: NotebookNode) -> None:
    """Say, in place, what each picture shows, for who cannot see it."""
    above = ""
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            above = cell.source
        for output in _pictures(NotebookNode(cells=[cell])):
            output.metadata.setdefault("image/png", NotebookNode())["alt"] = alt_text(cell, above)


def fit_pictures(notebook: NotebookNode) -> None:
    """Give, in place, each picture the finest of `SIZES` with which it and the chapter fit.

    Figures come with two dots for each dot on the page (`plotting.sharp_figures`). What is too
    large loses colours and then dots; in a chapter that is too large, all pictures alike. A film
    is stored as it is: what draws it has made it small.
    """
    fitted = [_Fitted(output) for output in _pictures(notebook)]
    for one in fitted:
        while one.bytes > MOST_PICTURE_BYTES and one.sizes:
            one.store_smaller()
    while _bytes(notebook) > MOST_CHAPTER_BYTES and any(one.sizes for one in fitted):
        left = [one for one in fitted if one.sizes]
        max(left, key=lambda one: (len(one.sizes), one.bytes)).store_smaller()


class _Fitted:
    """An output, its picture as it was drawn, and the sizes that are still smaller."""

    def __init__(self, output: NotebookNode) -> None:
        known = output.metadata.setdefault("image/png", NotebookNode())
        sharp = "width" in known  # else it has one dot for each on the page
        self.output, self.sizes = output, [size for size in SIZES if sharp or size[0] == 1.0]
        self.drawn = opened(output.data["image/png"])
        width, height = self.drawn.size
        output.metadata["image/png"] = NotebookNode(width=width, height=height) | known
        if is_film(self.drawn):
            self.sizes, self.bytes = [], len(base64.b64decode(output.data["image/png"]))
        else:
            self.store_smaller()

    def store_smaller(self) -> None:
        """Store the next size."""
        part, colours = self.sizes.pop(0)
        width, height = (round(part * side) for side in self.drawn.size)
        image, small = self.drawn.convert("RGB"), io.BytesIO()
        quantized(image.resize((width, height), Resampling.LANCZOS), colours).save(
            small, "PNG", optimize=True
        )
        self.bytes = len(small.getvalue())
        self.output.data["image/png"] = base64.b64encode(small.getvalue()).decode()


def quantized(image: Image.Image, colours: int) -> Image.Image:
    """With a palette that spans the colours of a picture: a red dot on grey stays red."""
    # First the corners of what there is; then the mean of all that is nearest to each of them.
    method, dither = Image.Quantize.MAXCOVERAGE, Image.Dither.NONE
    return image.quantize(colours, method=method, kmeans=1, dither=dither)


def keep_pictures(notebook: NotebookNode, stored: NotebookNode) -> None:
    """Take back, in place, each stored picture whose pixels are those of the new one."""
    known = {pixels(o.data["image/png"]): o.data["image/png"] for o in _pictures(stored)}
    for output in _pictures(notebook):
        picture = output.data["image/png"]
        output.data["image/png"] = known.get(pixels(picture), picture)


def pixels(picture: str) -> bytes:
    """Digest of size and pixels of a PNG in base64, whatever its compression and metadata.

    Of a film, each frame and how long it is shown.
    """
    digest, image = hashlib.sha256(), opened(picture)
    for frame in ImageSequence.Iterator(image):
        digest.update(repr((frame.size, frame.info.get("duration"))).encode())
        digest.update(frame.convert("RGBA").tobytes())
    return digest.digest()


def opened(picture: str) -> Image.Image:
    """A PNG in base64 as an image; a film has several frames."""
    return Image.open(io.BytesIO(base64.b64decode(picture)))


def is_film(image: Image.Image) -> bool:
    """Whether a picture moves."""
    return getattr(image, "n_frames", 1) > 1


def readme_picture(notebook: NotebookNode) -> str | None:
    """Picture in base64 that a chapter gives to the README, where it has one."""
    chosen = [c for c in notebook.cells if README_TAG in c.metadata.get("tags", [])]
    found = [o.data["image/png"] for o in _pictures(NotebookNode(cells=chosen))]
    return found[0] if found else None


def refresh(path: Path) -> bool:
    """Run one chapter and store it; tells whether its file changed."""
    before = path.read_text(encoding="utf-8")
    stored = nbformat.reads(before, as_version=4)
    fresh = tidy(execute(nbformat.reads(before, as_version=4), path.parent))
    name_pictures(fresh)
    fit_pictures(fresh)
    keep_pictures(fresh, stored)
    if (picture := readme_picture(fresh)) is not None:
        _replace(path.parent / README_PICTURE, base64.b64decode(picture))
    nbformat.validate(fresh)
    after = nbformat.writes(fresh) + "\n"
    if after != before:
        _replace(path, after.encode())
    return after != before


def main(paths: list[str]) -> int:
    """Refresh chapters in turn; answers the number of those that failed."""
    failed = 0
    for path in map(Path, paths):
        try:
            print(f"{path.name}: {'stored anew' if refresh(path) else 'unchanged'}", flush=True)
        except Exception as problem:
            failed += 1
            print(f"{path.name}: left as it was\n{problem}", file=sys.stderr, flush=True)
    return failed


def _cell_id(cell: NotebookNode, used: dict[str, int]) -> str:
    digest = hashlib.sha256(f"{cell.cell_type}\n{cell.source}".encode()).hexdigest()[:8]
    used[digest] = used.get(digest, 0) + 1
    return digest if used[digest] == 1 else f"{digest}-{used[digest]}"


def _outputs_with(notebook: NotebookNode, kind: str) -> Iterator[Any]:
    for cell in notebook.cells:
        yield from (o for o in cell.get("outputs", []) if kind in o.get("data", {}))


def _pictures(notebook: NotebookNode) -> Iterator[Any]:
    return _outputs_with(notebook, "image/png")


def _bytes(notebook: NotebookNode) -> int:
    return len(nbformat.writes(notebook).encode())


def _replace(path: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    path.parent.mkdir(exist_ok=True)
    beside = path.with_name(f".{path.name}.new")
    beside.write_bytes(content)
    beside.replace(path)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
