"""Files that segmap does not read: what they are, and what opens them in Python."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

#: First bytes of files that others read -> what they are, and what makes a table of them.
OTHER_FILES = {
    b"#ROSBAG V": "of ROS, a bag: the package segmap_app reads it, and is not installed here",
    b"SQLite format 3": "of SQLite: bags of ROS 2 are, which the package segmap_app reads",
    b"\x89MCAP0\r\n": "of ROS 2, a bag: the package segmap_app reads it, and is not installed here",
}
#: First bytes of files that three lines of Python read -> what they are, and these lines.
OPENED_FILES = {
    b"\x93NUMPY": (
        "an array of numpy's",
        "import numpy\n"
        "array = numpy.load({name!r})\n"
        "numpy.savetxt({name!r} + '.csv', array.reshape(-1, array.shape[-1]), delimiter=',')",
    ),
    b"\x54\x2c": (
        "packets of an LD06 or LD19",
        "import numpy\n"
        "beam = [('range_mm', '<u2'), ('quality', 'u1')]\n"
        "packets = numpy.fromfile({name!r}, [('head', 'u2'), ('speed', '<u2'), ('first', '<u2'), "
        "('beams', beam, 12), ('last', '<u2'), ('time_ms', '<u2'), ('sum', 'u1')])",
    ),
}
#: A line of words or numbers, then numbers in brackets.
NUMBERS_LISTED = r"""\A[^\[\]{}"'\n]*\[(?:[^\[\]:,"'\n]+,){2,}[^\[\]"'\n]*\](?:\n|\Z)"""
#: What a text has that is no table -> what it is, and what opens it.
OTHER_TEXTS = {
    r"(?m)^\s*\(?'?\[\(|\A.*\[\(": (
        "lists of Python, printed",
        "import ast\nwith open({name!r}) as file:\n"
        "    scans = [ast.literal_eval(line[line.index('['):]) for line in file if '[(' in line]",
    ),
    r"\A[\[{]+'": (
        "what Python prints",
        "import ast\nwith open({name!r}) as file:\n"
        "    records = [ast.literal_eval(line) for line in file if line.strip()]",
    ),
    NUMBERS_LISTED: (
        "lists of numbers, printed",
        "import numpy, re\nwith open({name!r}) as file:\n"
        "    rows = [re.findall(r'[-+.\\w]+', line.partition('[')[2]) for line in file]\n"
        "records = [numpy.array(row, float) for row in rows if row]",
    ),
    r"(?m)\A(?:---|\w+: *|- \w+:.*)$": (
        "YAML",
        "import yaml\nwith open({name!r}) as file:\n"
        "    records = [record for record in yaml.safe_load_all(file) if record]",
    ),
}
#: Of lines of words, each with several numbers.
NUMBERS_BETWEEN_WORDS = (
    "numbers between words",
    "import re\nwith open({name!r}) as file:\n"
    "    records = [re.findall(r'-?\\d+\\.?\\d*', line) for line in file]",
)
NUMBER = re.compile(r"\d+\.?\d*")
#: Lines of Python that read JSON with an object a line, and JSON that is one object.
JSON_LINES = (
    "import json\nwith open({name!r}) as file:\n    records = [json.loads(line) for line in file]"
)
JSON_WHOLE = "import json\nwith open({name!r}) as file:\n    records = json.load(file)"


def other_file(path: Path) -> str:
    """What a file is that its first bytes tell, and what opens it; empty of others."""
    with path.open("rb") as file:
        front = file.read(20)
    words = next((words for begin, words in OTHER_FILES.items() if front.startswith(begin)), "")
    opened = [each for begin, each in OPENED_FILES.items() if front.startswith(begin)]
    return _opening(*opened[0], path.name) if opened else f"is a file {words}" if words else ""


def other_text(name: str, lines: Sequence[str]) -> str:
    """What a text is that is no table, and what opens it; empty of others."""
    text, first = "\n".join(lines), lines[0].strip()
    for mark, (what, code) in OTHER_TEXTS.items():
        if re.search(mark, text):
            return _opening(what, code, name)
    if re.match(r'[\[{]\s*($|["\d\[{-])', first):
        is_lines = len(lines) > 1 and first.endswith(("}", "]"))
        return _opening("JSON", JSON_LINES if is_lines else JSON_WHOLE, name)
    return ""


def words_with_numbers(name: str, lines: Sequence[str]) -> str:
    """What opens lines that are alike but for several numbers between words; empty of others."""
    form, count = Counter(NUMBER.sub("0", line) for line in lines).most_common(1)[0]
    is_form = form.count("0") > 1 and re.search("[A-Za-z]", form) and 2 * count > len(lines)
    return _opening(*NUMBERS_BETWEEN_WORDS, name) if is_form else ""


def _opening(what: str, code: str, name: str) -> str:
    indented = code.replace("{name!r}", repr(name)).replace("\n", "\n    ")
    return f"is of no known format: it is {what}, which these lines open:\n    {indented}"
