"""Code asks for the kind of a reason, never for its words: these may be said otherwise tomorrow."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: Fields and variables that hold words for people, ...
FIELDS, NAMES = {"reason", "reasons", "doubt", "words"}, {"reason", "reasons"}
#: ... and what looks into a text.
READS = {"startswith", "endswith", "find", "search", "match", "fullmatch"}
#: Words of others that come without a kind.
LISTED = {
    # pyserial says it in no other way
    ("_port.py", "'exclusively lock' in str(error)"),
    # what a teacher wrote into a table of points
    ("_tasks.py", "PASSES.search(words)"),
}


def holds_words(node: ast.AST, more: frozenset[str] = frozenset()) -> bool:
    """Whether an expression is words, one of several, or the text of an error."""
    if isinstance(node, ast.Subscript):
        return holds_words(node.value, more)
    if isinstance(node, ast.Call):
        return ast.unparse(node) in {"str(error)", "str(fault)"}
    if isinstance(node, ast.Attribute):
        return node.attr in FIELDS
    return isinstance(node, ast.Name) and node.id in NAMES | more


def conditions(node: ast.AST) -> list[ast.expr]:
    """Expressions that decide, and what `and` and `or` in them join."""
    found = [getattr(node, "test", None), *getattr(node, "ifs", [])]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        found.append(node.operand)
    tests = [each for each in found if each is not None]
    return tests + [v for each in tests if isinstance(each, ast.BoolOp) for v in each.values]


def reads_words(text: str) -> list[str]:
    """Every place in a source where words of a result steer."""
    found: list[ast.AST] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Compare):
            found += [node] * any(map(holds_words, [node.left, *node.comparators]))
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") in READS:
            given = [getattr(node.func, "value", node), *node.args]
            found += [node] * any(holds_words(each, frozenset({"words"})) for each in given)
        for each in conditions(node):
            field = each.value if isinstance(each, ast.Subscript) else each
            if isinstance(field, ast.Attribute) and field.attr in NAMES:
                found.append(each)
    return [ast.unparse(node) for node in found]


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ('x = "more than" in places.reason', 1),
        ("if found.reason == LOOSE: pass", 1),
        ("n = sum(reason == LOOSE for reason in reasons)", 1),
        ('y = words.startswith("compiling")', 1),
        ('z = re.search("lost", belief.reason)', 1),
        ("w = [s for s in steps if not s.reason]", 1),
        ("v = 1 if match.reason and x else 2", 1),
        ('if "locked" in str(error): pass', 1),
        ('text = belief.reason or "found"', 0),
        ('said = f"{match.reason}; {words}"', 0),
        ("if found.unmatched is Unmatched.NONE: pass", 0),
        ("if reason: pass", 0),
    ],
)
def test_what_steers_by_words_is_seen(text, count):
    assert len(reads_words(text)) == count


def test_no_words_of_a_result_steer():
    """Catches a rewording that changes what is found."""
    folders = ("segmap", "notebooks/segmap_course")
    sources = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    found = {(path.name, each) for path in sources for each in reads_words(path.read_text("utf-8"))}
    assert found == LISTED
