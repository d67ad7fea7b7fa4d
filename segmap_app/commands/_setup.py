"""A machine made ready: `segmap notebooks` copies the chapters, `segmap warm` compiles the loops.

The originals of chapters stay, and so does a student's work.
"""

from __future__ import annotations

import importlib
import json
import re
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from segmap import warm
from segmap.display import pip_install, plural
from segmap.files import chapters_folder, stat_file, write_bytes
from segmap.threads import cores

from ._output import print_line, progress
from .log_options import command

#: The chapter that is opened first.
FIRST_CHAPTER = "01_start_here.ipynb"
#: Links that lead out of the folder of the chapters lead nowhere in most copies: their words stay.
OUTSIDE = re.compile(rb"\[([^\[\]\n]+)\]\(\.\./[^)\n]*\)")
#: A panel lives in its kernel: without one Lab says "model not found" in place of its picture.
PANEL = re.compile(rb'\s*"application/vnd\.jupyter\.widget-view\+json": \{[^{}]*\},(?=\s*")')
#: What a chapter links to beside itself: a picture, another text.
LINKED_FILE = re.compile(rb"\]\(([\w/-]+\.(?!ipynb)\w+)[^)\n]*\)")
#: Beside the chapters: here the checks of the course keep each function that passes.
OWN_FUNCTIONS = "my_mapper.py"


@command(
    "notebooks", "notebooks work", "notebooks work       again, once segmap is newer", "notebooks ."
)
def copy_chapters(folder: Path, /) -> None:
    """Copy the chapters into a folder of yours.

    What is there stays, for it may be a student's work.

    Parameters
    ----------
    folder
        It is made if it is not there.
    """
    source = chapters_folder()
    folder.mkdir(parents=True, exist_ok=True)
    is_in_clone = folder.resolve().parent == source.parent
    files = originals(source, outside=is_in_clone)
    if folder.resolve() != source.resolve():
        files = {name: PANEL.sub(b"", content) for name, content in files.items()}
        files[OWN_FUNCTIONS] = b'"""My functions: a check that passes adds the function below."""\n'
    absent = [name for name in files if not stat_file(folder / name)]
    for name in absent:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_bytes(folder / name, files[name])
    chapters = [name for name in files if name.endswith(".ipynb")]
    copied = [name for name in chapters if name in absent]
    _sign(files[name] for name in copied)
    changed = [n for n in chapters if _cells(files[n]) != _cells((folder / n).read_bytes())]
    print_line(f"{plural(len(copied), 'chapter')} copied to {folder}")
    if same := len(chapters) - len(copied) - len(changed):
        print_line(f"{plural(same, 'chapter')} there already")
    if changed:
        print_line(f"left as they are, since yours differ: {', '.join(changed)}")
        print_line("rename one of these, and run this again, to get the chapter as it is now")
    if not is_in_clone:
        print_line(
            f"open them with: jupyter lab {folder / FIRST_CHAPTER}  (needs: {pip_install('lab')})"
        )


def originals(source: Path, *, outside: bool) -> dict[str, bytes]:
    """Name and content of the chapters of a folder, and of what they link to beside them.

    `outside` tells whether links that lead out of the folder lead somewhere in the copy too.
    """
    files = {path.name: path.read_bytes() for path in sorted(source.glob("*.ipynb"))}
    linked = {name.decode() for text in files.values() for name in LINKED_FILE.findall(text)}
    files |= {name: (source / name).read_bytes() for name in linked if (source / name).is_file()}
    return files if outside else {name: OUTSIDE.sub(rb"\1", text) for name, text in files.items()}


def _cells(chapter: bytes) -> Any:
    """Kinds and sources of the cells that are not empty, which stay where Jupyter runs and saves.

    All of a file that is no notebook.
    """
    try:
        sources = [(c["cell_type"], "".join(c["source"])) for c in json.loads(chapter)["cells"]]
        return [source for source in sources if source[1].strip()]
    except (ValueError, KeyError, TypeError):
        return chapter


def _sign(chapters: Iterable[bytes]) -> None:
    """Tell Jupyter that these are ours: it shows their outputs, and does not call them untrusted.

    Only what was just copied, to the last byte: nothing is trusted that somebody has put in.
    """
    try:
        from nbformat import reads
        from nbformat.sign import NotebookNotary
    except ImportError:
        return
    notary = NotebookNotary()  # type: ignore[no-untyped-call]
    for content in chapters:
        with suppress(Exception):  # no home, or no notebook: it is looked at as any other
            notary.sign(reads(content.decode(), as_version=4))  # type: ignore[no-untyped-call]


@command("warm", "warm", "warm --first", "warm         again, once segmap is newer")
def compile_loops(*, first: bool = False) -> None:
    """Compile all loops now instead of at first use, on all cores.

    Parameters
    ----------
    first
        Only what chapter 01 needs.
    """
    names, start = list(warm.FIRST if first else warm.cases()), time.monotonic()
    jobs = min(cores(), len(names))
    where = "one core" if jobs == 1 else f"{jobs} cores"
    what = "chapter 01" if first else "segmap"
    print_line(f"Compiling the loops of {what} on {where}, once for this machine ...")
    importlib.import_module("matplotlib.font_manager")  # lists the machine's fonts, once
    case_of, done = warm.cases(), set[Any]()
    with progress(len(warm.loops(case_of[name] for name in names)), "loop") as bar:
        bar.bar_format = "compiling loop {n_fmt} of {total_fmt} |{bar}|"
        for name in _run_all(names, jobs):
            done |= warm.loops([case_of[name]])
            bar.update(len(done) - bar.n)
    print_line(f"Done in {time.monotonic() - start:.0f} s.")


def _run_all(names: list[str], jobs: int) -> Iterator[str]:
    """Run cases; each is named when it is done."""
    if jobs == 1:
        for name in names:
            warm.run_case(name)
            yield name
        return
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    # Processes, not threads: numba compiles one function at a time.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(warm.run_case, name): name for name in names}
        for done in as_completed(running):
            done.result()
            yield running[done]
