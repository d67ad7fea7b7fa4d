"""No name has two meanings in the library: constants and functions of modules that share one."""

import ast
import re
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: Names of a declared interface: each file does the same for its own format or command.
INTERFACE = {
    "add": "a command: adds its parser",
    "check": "a command: refuses options that contradict each other before any work",
    "run": "a command: does its work",
    "main": "a program: its entry point",
    "claims": "a reader: whether a file is of its format",
    "read": "a reader: the log of a file; `readers.read` of any",
    "SUFFIXES": "a command or a reader: ends of names that it takes",
    "METHODS": "a family: its methods by name",
    "build_map": "a family of maps: a map of a log and poses",
}
#: Other names that stand in several files, at most ten of each kind, each with its reason.
SHARED_CONSTANTS: dict[str, str] = {}
SHARED_FUNCTIONS = {
    "__getattr__": "a package: what it loads when it is first named",
    "between": "`poses.between`, and the same without checks in `poses.motions`",
    "compose": "`poses.compose`, and the same without checks in `poses.motions`",
    "inverse": "`poses.inverse`, and the same without checks in `poses.motions`",
    "transform": "`poses.transform`, and the same without checks in `poses.motions`",
    "wrap": "`angles.wrap`, and the same without checks in `poses.motions`",
    "axial_difference": "`angles.axial_difference`, and of two numbers in plain loops",
    "extreme_projections": "that of `segments`, and of plain points in plain loops",
    "gap_along": "that of `kernels`, and of plain segments in plain loops",
    "polyline": "a reduction by the name of its paper, and walls along corners in `simulation`",
}


def shared(sources: dict[str, str]) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    """Constants and functions of modules that are defined in several files, each with the files."""
    constants, functions = defaultdict[str, list[str]](list), defaultdict[str, list[str]](list)
    for name, text in sources.items():
        here: set[tuple[str, str]] = set()
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                here.add(("function", node.name))
            targets = node.targets if isinstance(node, ast.Assign) else []
            targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
            for target in targets:
                for each in target.elts if isinstance(target, ast.Tuple) else [target]:
                    if isinstance(each, ast.Name) and each.id.isupper() and len(each.id) > 1:
                        here.add(("constant", each.id))
        for kind, found in sorted(here):
            (constants if kind == "constant" else functions)[found].append(name)
    several = [{k: v for k, v in d.items() if len(v) > 1} for d in (constants, functions)]
    return several[0], several[1]


def library() -> dict[str, str]:
    return {str(f.relative_to(ROOT)): f.read_text() for f in sorted(ROOT.glob("segmap/**/*.py"))}


def together(sources: dict[str, str]) -> list[str]:
    """Statements that give several constants of a module a value at once."""
    return [
        f"{name}:{node.lineno}"
        for name, text in sources.items()
        for node in ast.parse(text).body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Tuple)
        and any(isinstance(each, ast.Name) and each.id.isupper() for each in target.elts)
    ]


@pytest.mark.parametrize(
    ("kind", "held"), [("constants", SHARED_CONSTANTS), ("functions", SHARED_FUNCTIONS)]
)
def test_no_name_of_a_module_has_two_meanings(kind, held):
    """Catches a `NEAR` of cells beside one of walls, and six functions `spread`."""
    found = shared(library())[kind == "functions"]
    new = {name: files for name, files in found.items() if name not in {**INTERFACE, **held}}
    assert not new, f"{kind} with one name: say in each what it is, with its unit"
    assert set(held) <= set(found), "names that are no longer shared leave the list"
    assert len(held) <= 10 and all(held.values())


def test_each_constant_has_its_own_line():
    """Catches two thresholds on one line: one comment then tells of two units."""
    assert together(library()) == []


def test_shared_names_and_tuples_are_found():
    """Catches a search that sees no annotated constant, no private name and no tuple."""
    one = "NEAR: float = 0.1\nA_M, B_M = 1, 2\ndef _gap(): ...\nclass Box:\n    FAR = 1\n"
    other = "NEAR = 2\ndef _gap():\n    def inner(): ...\nFAR = inner = 3\nB_M = 5\n"
    constants, functions = shared({"one": one, "other": other})
    assert constants == {"NEAR": ["one", "other"], "B_M": ["one", "other"]}
    assert functions == {"_gap": ["one", "other"]}
    assert together({"one": one, "other": other}) == ["one:2"]


#: Names that do not say what a variable is.
PARTICIPLES = "found|known|held|said|told|kept|given|made"


def test_examples_name_what_they_show():
    """Catches `found = pose_graph(log)`, from which a reader does not learn that it aligns."""
    assigned = rf"^ *(?:>>> |\.\.\. +|)((?:{PARTICIPLES}) = .*)"
    pages = [ROOT / "README.md", *ROOT.glob("docs/*.md")]
    examples = {path: path.read_text(encoding="utf-8") for path in pages}
    for path in (*ROOT.glob("segmap/**/*.py"), *ROOT.glob("notebooks/segmap_course/**/*.py")):
        lines = re.findall(r"^ *(?:>>>|\.\.\.) .*$", path.read_text("utf-8"), re.MULTILINE)
        examples[path] = "\n".join(lines)
    named = {p: re.findall(assigned, text, re.MULTILINE) for p, text in examples.items()}
    assert {str(p): lines for p, lines in named.items() if lines} == {}
