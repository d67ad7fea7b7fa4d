"""The method that a chapter writes in its cells is that of `literal` or of the library.

A chapter is in the new form where a cell is tagged `predict`. CONTRIBUTING, *A new chapter*, says
how it goes.
"""

import ast
import copy
import csv
import functools
import json
import re

import pytest
from chapter_rules import CHAPTERS, ROOT, code_cells, markdown, parsed, tags_of

from segmap import alignment, extraction, matching, reduction

LITERAL = ROOT / "notebooks" / "segmap_course" / "literal"


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


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem[:2])
def test_cells_are_the_readable_copy(path):
    """Catches a method that drifts between the chapter and the package."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    if not any("predict" in tags_of(cell) for cell in notebook["cells"]):
        return
    functions = list(defined(notebook))
    last = max((number for number, _, file in functions if file), default=-1)
    assert last >= 0, "no cell writes a function of `literal` or of the library"
    assert [
        f"cell {number}: {name} is not that of `literal` or of the library"
        for number, name, file in functions
        if file is None and (number < last or name in known_functions())
    ] == []


#: Method -> its chapter, the beginning of a heading, a function of its cells, panel and exercise.
TABLE = (ROOT / "tests/course/walked_through.csv").read_text(encoding="utf-8")
WALKED = {row["method"]: row for row in csv.DictReader(TABLE.splitlines())}


def test_every_method_is_in_the_table():
    """Catches a new method without a chapter."""
    names = [*alignment.METHODS, *reduction.METHODS, *matching.MATCHERS, *extraction.METHODS]
    assert set(names) == {*WALKED, "odometry", "ground_truth"}


@pytest.mark.parametrize("name", WALKED)
def test_a_method_keeps_code_panel_and_exercise(name):
    """Catches a method that is called and not shown; what is printed is the package's own."""
    row = WALKED[name]
    (path,) = (path for path in CHAPTERS if path.stem[:2] == row["chapter"])
    notebook = json.loads(path.read_text(encoding="utf-8"))
    code, source = "\n".join(source for _, source, _ in code_cells(notebook)), row["source"]
    assert any(one == source and file for _, one, file in defined(notebook)) or (
        re.search(rf"inspect\.getsource\({source}(\.plain)?\)", code)
    )
    assert f"# {row['section']}" in markdown(notebook)
    assert f"course.{row['panel']}(" in code and f"course.check_{row['exercise']}(" in code


def test_at_most_one_claim_in_three_holds_here_alone():
    """Catches a course of examples. `pytest -s` prints the count: a claim is a sentence of a
    summary without a link, and says *here* where it was not tried on more than its own case.
    """
    claims = []
    for path in CHAPTERS:
        text = markdown(json.loads(path.read_text(encoding="utf-8"))).split("## Summary")[-1]
        sentences = re.split(r"(?<=[.!?:])\s+|\n\n|\n(?=[-|])", text)
        claims += [one for one in sentences if len(one.split()) > 3 and "](" not in one]
    here = [one for one in claims if re.search(r"\bhere\b", one, re.IGNORECASE)]
    print(f"\n{len(here)} of {len(claims)} claims hold here alone")
    assert len(claims) > 100 and len(here) / len(claims) < 1 / 3
