"""`segmap notebooks DIR`: chapters to work in; the originals stay, and so does a student's work."""

from __future__ import annotations

import argparse
import hashlib
import json
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from segmap.display import counted, pip_install
from segmap.files import chapters_folder, existing, write_bytes

from ._output import print_line
from .log_options import examples

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
#: Which original was handed over last: the digest of its content, and that of its cells.
RECORD = ".originals.json"


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "notebooks",
        help="copy the chapters into a folder of yours",
        epilog=examples(
            "notebooks work", "notebooks work       again, once segmap is newer", "notebooks ."
        ),
    )
    command.add_argument("folder", metavar="DIR", type=Path, help="it is made if it is not there")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> None:
    """Copy what is not there; other cells are a student's work: a newer original goes beside it."""
    folder, source = given.folder, chapters_folder()
    folder.mkdir(parents=True, exist_ok=True)
    near = folder.resolve().parent == source.parent
    files, handed, home = originals(source, outside=near), _handed(folder), source.resolve()
    if folder.resolve() != home:
        files = {name: PANEL.sub(b"", content) for name, content in files.items()}
    done = {name: _hand_over(folder, name, files[name], handed) for name in files}
    write_bytes(folder / RECORD, json.dumps(handed).encode())
    if folder.resolve() != home and not existing(folder / OWN_FUNCTIONS):
        text = '"""My functions: a check that passes adds the function below."""\n'
        write_bytes(folder / OWN_FUNCTIONS, text.encode())
    _sign(files[name] for name in files if done[name] == "copied" and name.endswith(".ipynb"))
    _tell(folder, done)
    if not near:
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


def _handed(folder: Path) -> dict[str, str]:
    """Which originals a folder was given, as its record says."""
    try:
        found = json.loads((folder / RECORD).read_bytes())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _hand_over(folder: Path, name: str, content: bytes, handed: dict[str, str]) -> str:
    """Copy an original unless work is there; what became of it, and in `handed` its digests."""
    path, now = folder / name, _digests(content)
    before, handed[name] = handed.get(name), now
    there = path.read_bytes() if existing(path) else None
    if there == content:
        return "there already"
    cells = before.split()[-1:] if before else []
    if there is None or _digests(there).split()[-1] in (*cells, now.split()[-1]):
        if there is not None and before == now:
            return "there already"  # opened, or run: what it shows is of this original
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, content)
        return "copied"
    if before is None or before == now:
        return "yours"
    count = 1  # a newer original goes beside the student's, under a name that is not taken
    while existing(beside := path.with_name(f"{path.stem}.newer-{count}{path.suffix}")):
        count += 1
    write_bytes(beside, content)
    return beside.name


def _digests(content: bytes) -> str:
    """Of a file; and of the sources of its cells, where it is a notebook, the empty ones left out.

    What Jupyter changes where a chapter is opened, run or saved is not in the second.
    """
    whole = cells = hashlib.sha256(content).hexdigest()
    with suppress(ValueError, KeyError, TypeError, RecursionError):
        sources = ((c["cell_type"], "".join(c["source"])) for c in json.loads(content)["cells"])
        text = json.dumps([source for source in sources if source[1].strip()])
        cells = hashlib.sha256(text.encode()).hexdigest()
    return f"{whole} {cells}"


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


def _tell(folder: Path, done: dict[str, str]) -> None:
    """Say what was done, and where a newer original lies."""
    kinds = [kind for name, kind in done.items() if name.endswith(".ipynb")]
    print_line(f"{counted(kinds.count('copied'), 'chapter')} copied to {folder}")
    if same := kinds.count("there already"):
        print_line(f"{counted(same, 'chapter')} there already")
    if yours := [name for name, kind in done.items() if kind == "yours"]:
        print_line(f"left as they are, since yours differ: {', '.join(yours)}")
        print_line("rename one of these, and run this again, to get the chapter as it was")
    kept = {"copied", "there already", "yours"}
    for name, kind in done.items():
        if kind not in kept:
            print_line(f"{name} is newer than yours, which stays: the new one is {folder / kind}")
