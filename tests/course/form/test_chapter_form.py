"""What a chapter in the new form must hold, one function a rule: `rule(notebook) -> complaints`.

A chapter is in the new form where a cell is tagged `predict`. CONTRIBUTING, *A new chapter*, says
how it goes.
"""

import ast
import copy
import functools
import json
import re

import pytest
import segmap_course as course
from chapter_rules import (
    CHAPTERS,
    ROOT,
    code_cells,
    in_the_new_form,
    is_guard,
    lines_of,
    markdown,
    outputs,
    parsed,
)

MOST_WORDS, MOST_CELLS, MOST_LINES = 1000, 30, 120
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
LITERAL = ROOT / "notebooks" / "segmap_course" / "literal"


# ------------------------------------------------------------------ sizes


def words_of(notebook):
    return len(re.findall(r"[^\s|]*\w[^\s|]*", markdown(notebook)))


def lines_of_code(notebook):
    return sum(bool(line.strip()) for _, s, _ in code_cells(notebook) for line in s.splitlines())


def has_room_for_nothing_else(notebook):
    sizes = {
        "words": (words_of(notebook), MOST_WORDS),
        "cells of code": (len(list(code_cells(notebook))), MOST_CELLS),
        "lines of code": (lines_of_code(notebook), MOST_LINES),
    }
    return [f"{n} {what}, more than {most}" for what, (n, most) in sizes.items() if n > most]


# ------------------------------------------------------------------ predictions and answers


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


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem[:2])
def test_a_chapter_has_its_form(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    rules = (has_room_for_nothing_else, no_text_states_the_answer, cells_are_the_readable_copy)
    rules = rules if in_the_new_form(notebook) else ()
    assert [f"{rule.__name__}: {said}" for rule in rules for said in rule(notebook)] == []


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
