"""The page *Map of the code*: layers, what each may import, and where to begin reading."""

import ast
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SEGMAP = ROOT / "segmap"

#: From the ground up: name, what it holds, the folders and files of `segmap` that stand on it.
#: Those of the app have its name before theirs.
LAYERS = (
    (
        "Ground",
        "arrays that are checked, poses, segments, scans",
        "progress compiled display arrays files threads methods angles poses segments scans "
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
        "sensors reduction quadtree alignment matching plan",
    ),
    (
        "Around the methods",
        "experiments, files that go out, drawings, panels of the chapters",
        "experiments exports testing warm carried plotting panels",
    ),
    (
        "The app",
        "for people with a log: files of other programs, from log to map, the page, the command",
        "segmap_app/files segmap_app/call segmap_app/pipeline segmap_app/plans "
        "segmap_app/drives "
        "segmap_app/page segmap_app/commands __main__",
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


def place_of(package: str) -> Path:
    """The folder or file of a package; those of the app are named with it."""
    folder = (ROOT if package.startswith("segmap_app") else SEGMAP) / package
    return folder if folder.is_dir() else folder.with_suffix(".py")


def imports_of(package: str) -> set[str]:
    """The packages of the map that one of them imports."""
    place = place_of(package)
    files = place.rglob("*.py") if place.is_dir() else [place]
    found: set[str] = set()
    for path in files:
        home = path.relative_to(ROOT).parts[:-1]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                base = home[: len(home) - node.level + 1] if node.level else ()
                whole = [*base, *(node.module.split(".") if node.module else ())]
                for name in node.names:
                    first, *rest = [*whole, name.name]
                    found |= {rest[0] if first == "segmap" else "/".join([first, *rest[:1]])}
    return (found & {name for _, _, names in LAYERS for name in names.split()}) - {package}


def words_of(package: str) -> str:
    """The first sentence of its docstring."""
    place = place_of(package)
    return first_line(place / "__init__.py" if place.is_dir() else place)


def first_line(path: Path) -> str:
    """The first line of the docstring of a file."""
    return (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").split("\n")[0]


def files_of(package: str) -> list[Path]:
    """The files of a folder that hold more than its list of names."""
    found = sorted(place_of(package).rglob("*.py"))
    return [path for path in found if path.name not in ("__init__.py", "__main__.py")]


def picture() -> str:
    """The layers as SVG, the ground below, a box for each folder or file."""
    parts, y = [], GAP
    for name, _, packages in reversed(LAYERS):
        parts.append(f'<text x="0" y="{y + 18}" font-weight="bold">{escape(name)}</text>')
        x = 170.0
        for package in packages.split():
            width = 14 + 8.2 * len(package)
            if x + width > WIDTH:
                x, y = 170.0, y + BOX_HEIGHT + GAP
            parts.append(
                f'<rect x="{x:g}" y="{y}" width="{width:g}" height="{BOX_HEIGHT}" rx="4" '
                f'fill="none" stroke="currentColor"/>'
                f'<text x="{x + width / 2:g}" y="{y + 18}" text-anchor="middle">{package}</text>'
            )
            x += width + GAP
        y += BOX_HEIGHT + 3 * GAP
    return (
        f'<svg viewBox="0 0 {WIDTH} {y}" role="img" aria-label="The layers of segmap" '
        f'font-size="13" font-family="sans-serif" fill="currentColor">{"".join(parts)}</svg>'
    )


def code_map() -> str:
    """The page, as Markdown."""
    lines = ["# Map of the code", ""]
    lines += ["Five layers. A layer imports its own and lower ones, never a higher one, and the"]
    lines += ["library never imports the course; of its files `__main__.py` alone imports the app."]
    lines += ["`tests/project/test_imports.py` holds it.", ""]
    lines += ["```{raw} html", picture(), "```", ""]
    for number, (name, words, packages) in enumerate(LAYERS, 1):
        lines += [f"## {number} {name}", "", f"{words[0].upper()}{words[1:]}.", ""]
        lines += ["| | what it is | imports |", "|---|---|---|"]
        for package in packages.split():
            used = ", ".join(f"`{each}`" for each in sorted(imports_of(package)))
            lines += [f"| `{package}` | {words_of(package)} | {used} |"]
        lines += [""]
    lines += ["## Where to begin reading", ""]
    lines += [f"{k}. `{path}`: {words}." for k, (path, words) in enumerate(FIRST, 1)]
    lines += ["", "Then the tests of what you read: `tests/` has the same folders.", ""]
    lines += ["## Which file holds what", "", "Search this page for the field's word.", ""]
    lines += ["| file | what is in it |", "|---|---|"]
    for package in sorted(name for _, _, names in LAYERS for name in names.split()):
        for path in files_of(package):
            lines += [f"| `{path.relative_to(ROOT)}` | {first_line(path)} |"]
    lines += [""]
    return "\n".join(lines)
