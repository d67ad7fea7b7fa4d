"""The page *Map of the code*: storeys, what each may import, and where to begin reading."""

import ast
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SEGMAP = ROOT / "segmap"

#: From the ground up: name, what it holds, the folders and files of `segmap` that stand on it.
STOREYS = (
    (
        "Ground",
        "arrays that are checked, poses, segments, scans",
        "progress compiled _display arrays files threads methods _call angles poses segments scans "
        "kernels",
    ),
    (
        "Logs and measures",
        "a log comes in, by a reader or a simulation; segments come out of it; maps are measured",
        "readers simulation extraction metrics",
    ),
    (
        "Methods",
        "reduction, quadtree, alignment, matching, floor plans; the sensor",
        "hokuyo reduction quadtree alignment matching plan",
    ),
    (
        "Around the methods",
        "experiments, files that go out, drawings, the whole way from log to map",
        "experiments exports testing _warm _map_pipeline plotting",
    ),
    (
        "Entry points",
        "what people touch: panels and the page, commands",
        "panels _commands __main__",
    ),
)
#: Files to begin with, in this order, and what each shows.
FIRST = (
    ("segmap/scans/_scans.py", "`LaserScan` and `Log`, what everything else takes"),
    ("segmap/reduction/_fusion.py", "a whole method on one page, and how the runner is called"),
    ("segmap/alignment/_point_icp.py", "an alignment: scan by scan on a map that grows"),
    ("segmap/quadtree/_map.py", "the other kind of map"),
    ("notebooks/segmap_course/literal/reduction/fusion.py", "the same method as plain loops"),
)
WIDTH, BOX_HEIGHT, GAP = 860, 26, 8


def imports_of(room: str) -> set[str]:
    """The folders and files at the top of `segmap` that one of them imports."""
    folder = SEGMAP / room
    files = folder.rglob("*.py") if folder.is_dir() else [SEGMAP / f"{room}.py"]
    found: set[str] = set()
    for path in files:
        depth = len(path.relative_to(SEGMAP).parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == depth:
                found |= (
                    {node.module.split(".")[0]} if node.module else {a.name for a in node.names}
                )
    return (found & {name for _, _, names in STOREYS for name in names.split()}) - {room}


def words_of(room: str) -> str:
    """The first sentence of its docstring."""
    path = SEGMAP / room / "__init__.py" if (SEGMAP / room).is_dir() else SEGMAP / f"{room}.py"
    return (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").split("\n")[0]


def picture() -> str:
    """The storeys as SVG, the ground below, a box for each folder or file."""
    parts, y = [], GAP
    for name, _, rooms in reversed(STOREYS):
        parts.append(f'<text x="0" y="{y + 18}" font-weight="bold">{escape(name)}</text>')
        x = 170.0
        for room in rooms.split():
            width = 14 + 8.2 * len(room)
            if x + width > WIDTH:
                x, y = 170.0, y + BOX_HEIGHT + GAP
            parts.append(
                f'<rect x="{x:g}" y="{y}" width="{width:g}" height="{BOX_HEIGHT}" rx="4" '
                f'fill="none" stroke="currentColor"/>'
                f'<text x="{x + width / 2:g}" y="{y + 18}" text-anchor="middle">{room}</text>'
            )
            x += width + GAP
        y += BOX_HEIGHT + 3 * GAP
    return (
        f'<svg viewBox="0 0 {WIDTH} {y}" role="img" aria-label="The storeys of segmap" '
        f'font-size="13" font-family="sans-serif" fill="currentColor">{"".join(parts)}</svg>'
    )


def code_map() -> str:
    """The page, as Markdown."""
    lines = ["# Map of the code", ""]
    lines += ["Five storeys. A storey imports its own and lower ones, never a higher one, and the"]
    lines += ["library never imports the course. `tests/project/test_imports.py` holds it.", ""]
    lines += ["```{raw} html", picture(), "```", ""]
    for number, (name, words, rooms) in enumerate(STOREYS, 1):
        lines += [f"## {number} {name}", "", f"{words[0].upper()}{words[1:]}.", ""]
        lines += ["| | what it is | imports |", "|---|---|---|"]
        for room in rooms.split():
            used = ", ".join(f"`{each}`" for each in sorted(imports_of(room)))
            lines += [f"| `{room}` | {words_of(room)} | {used} |"]
        lines += [""]
    lines += ["## Where to begin reading", ""]
    lines += [f"{k}. `{path}`: {words}." for k, (path, words) in enumerate(FIRST, 1)]
    lines += ["", "Then the tests of what you read: `tests/` has the same folders.", ""]
    return "\n".join(lines)
