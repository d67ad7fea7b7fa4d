"""What a chapter in the new form must hold, one function a rule: `rule(notebook) -> complaints`.

A chapter is in the new form where a cell is tagged `predict`. CONTRIBUTING, *A new chapter*, says
how it goes.
"""

import ast
import base64
import copy
import functools
import io
import json
import re
from itertools import pairwise

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import (
    CHAPTERS,
    ROOT,
    code_cells,
    in_the_new_form,
    is_guard,
    lines_of,
    links,
    markdown,
    outputs,
    parsed,
    tags_of,
)
from PIL import Image

import segmap

MOST_WORDS, MOST_CELLS, MOST_LINES, MOST_MINUTES = 1000, 30, 120, 65
#: Minutes: words and lines of code that are read in one; a picture, a panel, a function to write.
WORDS, LINES, PICTURE, PANEL, FUNCTION = 120, 6, 0.75, 5, 20
#: A film: frames, bytes, and the least share of what is not white that changes from frame to frame.
FRAMES, MOST_FILM_BYTES, LEAST_CHANGE = (6, 12), 30_000, 0.02
VIEW = "application/vnd.jupyter.widget-view+json"
ASKED = re.compile(r"(\w+) = None +# (\S.*)")
NUMBERS = [
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
]
#: Part of `literal` -> the packages of the library that have the method, fast.
PACKAGES = {
    "alignment": {"alignment", "matching"},
    "reduction": {"reduction"},
    "quadtrees": {"quadtree", "matching"},
    "quadtrees/scores": {"matching"},
    "quadtrees/matching": {f"matching.{n}" for n in ("hill_climb", "sample_and_rank", "map_scans")},
    "metrics": {"metrics"},
    "extraction": {"extraction"},
    "line_finders": {"extraction"},
    "lines": {"segments", "extraction"},
    "floor_plan": {"plan"},
    "scip": {f"sensors.{name}" for name in ("checksum", "decode", "parse_scan")},
    "comparing": {"experiments"},
}
LITERAL = ROOT / "notebooks" / "segmap_course" / "literal"
#: What a chapter may call before its method stands: these, checks, and a log that is simulated.
ALLOWED = {"room_walk", *course.drawings.__all__, *course.panels.__all__, *course.figures.__all__}


# ------------------------------------------------------------------ sizes


def words_of(notebook):
    return len(re.findall(r"[^\s|]*\w[^\s|]*", markdown(notebook)))


def lines_of_code(notebook):
    return sum(bool(line.strip()) for _, s, _ in code_cells(notebook) for line in s.splitlines())


def pictures(notebook):
    return [lines_of(p) for _, o in outputs(notebook) if (p := o.get("data", {}).get("image/png"))]


def panels(notebook):
    """Cells that show a panel or a figure to drag."""
    return [number for number, output in outputs(notebook) if VIEW in output.get("data", {})]


def minutes(notebook):
    joined = "\n".join(source for _, source, _ in code_cells(notebook))
    functions = len(re.findall(r"^course\.check_\w+\(", joined, re.MULTILINE))
    read = words_of(notebook) / WORDS + lines_of_code(notebook) / LINES
    seen = PICTURE * len(pictures(notebook)) + PANEL * len(set(panels(notebook)))
    return read + seen + FUNCTION * functions


def has_room_for_nothing_else(notebook):
    sizes = {
        "words": (words_of(notebook), MOST_WORDS),
        "cells of code": (len(list(code_cells(notebook))), MOST_CELLS),
        "lines of code": (lines_of_code(notebook), MOST_LINES),
        "minutes": (round(minutes(notebook)), MOST_MINUTES),
    }
    return [f"{n} {what}, more than {most}" for what, (n, most) in sizes.items() if n > most]


# ------------------------------------------------------------------ question, prediction, answer


def has_question(notebook):
    """A title and a question; the claim stands in the summary."""
    first = lines_of(notebook["cells"][0]["source"])
    titled = notebook["cells"][0]["cell_type"] == "markdown" and re.match(r"# \d+ \S", first)
    return [] if titled and "?" in first else ["the first cell must be a title and a question"]


def tagged(notebook, tag):
    return [(k, cell) for k, cell in enumerate(notebook["cells"]) if tag in tags_of(cell)]


def asks_for_one_number(notebook):
    return [
        f"cell {k}: `name = None  # unit` is all that a cell tagged predict holds"
        for k, cell in tagged(notebook, "predict")
        if not ASKED.fullmatch(lines_of(cell["source"]).strip()) or cell["outputs"]
    ]


def answers_are_folded(notebook):
    """After the prediction, with an output, which Lab does not open by itself."""
    asked, revealed = tagged(notebook, "predict"), tagged(notebook, "reveal")
    if not revealed or revealed[0][0] < asked[0][0]:
        return ["a cell tagged reveal must answer, behind the prediction"]
    return [
        f"cell {k}: an answer without an output, or not folded: run make refresh"
        for k, cell in revealed
        if not cell["outputs"] or cell["metadata"].get("jupyter") != {"outputs_hidden": True}
    ]


def compares_with_the_prediction(notebook):
    """The last line of a cell that answers says how far off the prediction was."""
    names = [ASKED.match(lines_of(cell["source"])) for _, cell in tagged(notebook, "predict")]
    said = [lines_of(cell["source"]).strip() for _, cell in tagged(notebook, "reveal")]
    return [
        f"{name[1]} is compared with no answer: course.compare_prediction({name[1]}, ...)"
        for name in names
        if name and not any(f"compare_prediction({name[1]}," in source for source in said)
    ]


def answers(notebook):
    """Digits and unit of each answer."""
    shown = "".join(lines_of(o.get("data", {}).get("text/html", "")) for _, o in outputs(notebook))
    return re.findall(r'class="answer" data-answer="([^"]*)" data-unit="([^"]*)"', shown)


def no_text_states_the_answer(notebook):
    """Neither words nor comments; headings, links and formulas have numbers of their own."""
    comments = [
        line.partition("#")[2]
        for _, source, cell in code_cells(notebook)
        if not is_guard(cell)
        for line in source.splitlines()
    ]
    words = re.sub(r"\$\$.*?\$\$|\$[^$]+\$", "", markdown(notebook), flags=re.DOTALL)
    words = re.sub(r"^#.*$|\]\([^)]*\)|[Cc]hapters? \d+", "", words, flags=re.MULTILINE)
    text = "\n".join([words, *comments])
    found = []
    for digits, unit in answers(notebook):
        spelled = NUMBERS[int(digits) - 1] if digits.isdigit() and 0 < int(digits) < 13 else digits
        stated = rf"(?<![\d.]){re.escape(digits)}(?![\d.]*\d)|\b{spelled} {re.escape(unit)}"
        found += [f"the text says {m.group()!r}" for m in re.finditer(stated, text)]
    return found


# ------------------------------------------------------------------ the order of a chapter


def fails_and_looks_at_a_real_log(notebook):
    headings = "\n".join(re.findall(r"^#+ (.+)$", markdown(notebook), re.MULTILINE)).lower()
    wanted = {"When it fails": "wrong|fail", "On a real log": "real log"}
    return [f"no heading such as {h!r}" for h, p in wanted.items() if not re.search(p, headings)]


def ends_with_its_claim(notebook):
    """A summary: the claim, then what is next, with its link."""
    kind, last = notebook["cells"][-1]["cell_type"], lines_of(notebook["cells"][-1]["source"])
    parts = [part for part in last.split("\n\n") if part.strip()]
    right = kind == "markdown" and re.match(r"#+ Summary$", parts[0]) and len(parts) >= 2
    return [] if right and links(last) else ["the last cell must be a Summary: claim, what is next"]


# ------------------------------------------------------------------ the method as code


def without_annotation(node):
    """`walls: list[Wall] = []` as `walls = []`."""
    if isinstance(node, ast.AnnAssign) and node.value:
        return ast.copy_location(ast.Assign([node.target], node.value), node)
    return node


def bare(function):
    """A function without annotations, of its docstring the first line, compiled or not."""
    function = copy.deepcopy(function)
    function.decorator_list = [d for d in function.decorator_list if ast.unparse(d) != "compiled"]
    for node in ast.walk(function):
        for name, part in ast.iter_fields(node):
            if isinstance(part, list):
                setattr(node, name, [without_annotation(each) for each in part])
        if isinstance(node, ast.arg):
            node.annotation = None
        if isinstance(node, ast.FunctionDef):
            node.returns = None
    if text := ast.get_docstring(function):
        function.body[0] = ast.Expr(ast.Constant(text.splitlines()[0]))
    return ast.dump(function)


@functools.cache
def known_functions():
    """Name -> the functions of `literal` and of the library, each with its file."""
    found = {}
    for path in [*LITERAL.rglob("*.py"), *(ROOT / "segmap").rglob("*.py")]:
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                found.setdefault(node.name, []).append((path, bare(node)))
    return found


def defined(notebook):
    """Number of the cell, function, and the file that has the same; None where none has."""
    for number, cell in parsed(notebook):
        for node in cell.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("my_"):
                same = [p for p, code in known_functions().get(node.name, []) if code == bare(node)]
                yield number, node.name, same[0] if same else None


def last_step(notebook):
    """The last cell with a step of the method; -1 without one."""
    return max((number for number, _, file in defined(notebook) if file), default=-1)


def cells_are_the_readable_copy(notebook):
    last = last_step(notebook)
    if last < 0:
        return ["no cell writes a function of `literal` or of the library"]
    return [
        f"cell {number}: {name} is not that of `literal` or of the library"
        for number, name, file in defined(notebook)
        if file is None and (number < last or name in known_functions())
    ]


def packages_of(notebook):
    """Packages of the library that have the method of the chapter."""
    files = [file for _, _, file in defined(notebook) if file]
    own = [f.relative_to(LITERAL).with_suffix("") for f in files if f.is_relative_to(LITERAL)]
    inside = [p.as_posix() if p.as_posix() in PACKAGES else p.parts[0] for p in own]
    library = {f.relative_to(ROOT / "segmap").parts[0] for f in files if LITERAL not in f.parents}
    named = [PACKAGES.get(part, set()) for part in inside]
    return library.union(*named)


def imported(notebook):
    """Name in the chapter -> what it is called where it comes from."""
    names = {}
    for node in (node for _, cell in parsed(notebook) for node in ast.walk(cell)):
        if isinstance(node, ast.Import):
            names |= {a.asname or a.name: a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {a.asname or a.name: f"{node.module}.{a.name}" for a in node.names}
    return names


def calls(notebook):
    """Number of the cell, and the whole name of what it calls."""
    names = imported(notebook)
    for number, cell in parsed(notebook):
        for node in ast.walk(cell):
            if isinstance(node, ast.Call):
                first, *rest = ast.unparse(node.func).split(".")
                yield number, ".".join([names.get(first, first), *rest])


def is_of_the_method(name, packages):
    """Whether `segmap.fusion` or `segmap.reduction.fusion` is called, by the packages."""
    if f"{name}.".startswith(tuple(f"segmap.{package}." for package in packages)):
        return True
    called = getattr(segmap, name.removeprefix("segmap."), None) if name[:7] == "segmap." else None
    home = getattr(called, "__module__", "")
    return home.startswith(tuple(f"segmap.{package}." for package in packages))


def calls_nothing_too_early(notebook):
    """Until its last step stands, neither the method nor the course does the chapter's work."""
    last, packages = last_step(notebook), packages_of(notebook)
    found = []
    for number, name in calls(notebook):
        own = name.partition("segmap_course.")[2]
        early = own and own.split(".")[-1] not in ALLOWED
        early = early and not own.startswith(("check_", "literal.lines."))  # plain geometry
        if number <= last and (early or is_of_the_method(name, packages)):
            found.append(f"cell {number}: calls {name} before the method stands")
    return found


def cells_and_library_agree(notebook):
    """The first cell that calls the library's method asserts, or the guard below it."""
    last, packages = last_step(notebook), packages_of(notebook)
    used = [n for n, name in calls(notebook) if n > last and is_of_the_method(name, packages)]
    asserting = {
        n for n, c in parsed(notebook) if any(isinstance(x, ast.Assert) for x in ast.walk(c))
    }
    if used and {used[0], used[0] + 1} & asserting:
        return []
    return ["the first cell that calls the library's method must assert that both agree"]


# ------------------------------------------------------------------ films, in every chapter


def frames_of(picture):
    """The still picture and the frames of a film, as pixels; and what its file says."""
    film, found = Image.open(io.BytesIO(base64.b64decode(picture))), []
    for k in range(getattr(film, "n_frames", 1)):
        film.seek(k)
        found.append(np.asarray(film.convert("RGB"), int))
    return found, film.info


def films_move_and_end(notebook):
    found = []
    for number, output in outputs(notebook):
        picture = lines_of(output.get("data", {}).get("image/png", ""))
        if not picture or b"acTL" not in base64.b64decode(picture)[:200]:
            continue
        (still, *frames), info = frames_of(picture)
        size = len(base64.b64decode(picture))
        if not (info.get("default_image") and info["loop"] == 2 and (still == frames[-1]).all()):
            found.append(f"cell {number}: a film that does not end with its still picture")
        if not FRAMES[0] <= len(frames) <= FRAMES[1] or size > MOST_FILM_BYTES:
            found.append(f"cell {number}: a film of {len(frames)} frames and {size} bytes")
        for k, (one, other) in enumerate(pairwise(frames)):
            changed = (one != other).any(-1).sum() / max(1, (other != 255).any(-1).sum())
            if changed < LEAST_CHANGE:
                found.append(f"cell {number}: frame {k + 1} differs in {100 * changed:.1f} % only")
    return found


RULES = (has_room_for_nothing_else, has_question, asks_for_one_number, answers_are_folded,
         compares_with_the_prediction, no_text_states_the_answer,
         fails_and_looks_at_a_real_log, ends_with_its_claim,
         cells_are_the_readable_copy, calls_nothing_too_early, cells_and_library_agree,
         films_move_and_end)  # fmt: skip


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem[:2])
def test_a_chapter_has_its_form(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    own = RULES if in_the_new_form(notebook) else [films_move_and_end]
    assert [f"{rule.__name__}: {said}" for rule in own for said in rule(notebook)] == []


def is_constant(node):
    """Such as `MOVES = ...`, which a step of the method needs."""
    return isinstance(node, ast.Assign) and ast.unparse(node.targets[0]).isupper()


#: Number of a chapter -> a function of its cells, the exercise that it cannot do, and a word of the
#: hint that whoever pastes it reads.
PASTED = {
    "03": ("segments_at_gaps", "segments_all_round", "two parts"),
    "07": ("best_move", "move_onto_walls", "corridor"),
    "09": ("translation_of", "least_translation", "corridor"),
    "25": ("crossed_leaves", "crossed_leaves", "cut it first"),
    "27": ("climb_step", "climb_diagonally", "diagonally"),
    "26": ("distance_score", "capped_score", "unknown room"),
    "10": ("least_squares", "places_between", "takes a count"),
    "11": ("edge_residual", "edge_error", "do not subtract"),
    "12": ("quality", "quality", "quality of the chapter"),
    "13": ("lacking", "missed_metres", "make good"),
    "14": ("match", "matches", "match of the chapter"),
    "23": ("front", "front", "invented metres"),
    "15": ("map_origin", "pair_origin", "origin of the map"),
    "18": ("mean_segment", "mean_by_length", "scrap pulls"),
    "19": ("fitted", "steady_fit", "bends the line"),
    "20": ("kept_pieces", "surely_kept", "through the wall is enough"),
    "29": ("distances_of", "kept_distances", "whole scan"),
    "28": ("axis_of", "axes_of", "one axis of the chapter"),
}


@pytest.mark.parametrize("number", PASTED)
def test_the_chapter_s_own_cell_fails_with_its_hint(number):
    """Catches an exercise whose answer stands in the chapter."""
    (path,) = (path for path in CHAPTERS if path.name.startswith(number))
    names, (step, exercise, word) = {}, PASTED[number]
    for k, (_, cell) in enumerate(parsed(json.loads(path.read_text(encoding="utf-8")))):
        kinds = (ast.Import, ast.ImportFrom, ast.Assign) if k == 0 else ast.FunctionDef
        written = [n for n in cell.body if isinstance(n, kinds) or is_constant(n)]
        exec(compile(ast.Module(written, []), path.name, "exec"), names)
    check = getattr(course, f"check_{exercise}")(names[step])
    assert not check.passed and word in repr(check)


def code(source, *shown, tags=(), **metadata):
    made = [{"output_type": "display_data", "data": data} for data in shown]
    about = {"tags": list(tags), **metadata}
    return {"cell_type": "code", "metadata": about, "source": source, "outputs": made}


def test_a_film_of_the_course_passes():
    """Catches a film that `course.film` makes, and no chapter may show."""
    axes = (
        course.draw_scans([(0, 1)], [(0, 1)], (0.3 * k, 0, 0), view=(-1, -1, 3, 2))
        for k in range(6)
    )
    shown, _ = course.film((ax.figure for ax in axes), "it moves")._repr_mimebundle_()
    cell = code("film", shown)
    assert films_move_and_end({"cells": [cell]}) == []
