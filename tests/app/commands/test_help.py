"""What commands say of themselves, and of their methods."""

import io
import os
import re
import shlex
import subprocess
import sys
from contextlib import redirect_stdout, suppress
from functools import cache
from itertools import pairwise

import pytest
from conftest import slow
from programs import program

from segmap import alignment, extraction, reduction
from segmap_app.commands import APP

main = program("segmap")

FUNCTIONS = {
    name: getattr(method, "function", method)
    for room in (alignment, extraction, reduction)
    for name, method in room.METHODS.items()
}

#: What a command that is run as its help shows it waits for: a browser, a laser.
WAITS = {"app", "live"}


@cache
def said(*words):
    """What a command prints, where it ends so."""
    with redirect_stdout(io.StringIO()) as out, suppress(SystemExit):
        main([*words])
    return out.getvalue()


NAMES = re.findall(r"^│ (\w+)", said("--help"), re.MULTILINE)


def examples_of(name):
    """The lines below `Examples:`, without `segmap`, and without what is said of them."""
    lines = said(name, "--help").partition("Examples:")[2].strip().splitlines()
    return [re.split(r"\s{3,}", line.strip())[0].removeprefix("segmap ") for line in lines]


@pytest.mark.parametrize("name", [slow(n) if n in ("compare", "warm") else n for n in NAMES])
def test_examples_run_as_they_stand_one_after_the_other(run, tmp_path, name):
    """Catches an example that needs a file which nobody has, and an option that is gone."""
    examples = examples_of(name)
    assert sum(line.split()[0] == name for line in examples) >= 3
    for line in examples:
        words = shlex.split(line)
        if not WAITS & {words[0], " ".join(words[:2])}:
            assert run(*words)[0] == 0, line
            written = [file for flag, file in pairwise(words) if flag in ("-o", "--table")]
            assert all((tmp_path / f.replace("{name}", "room")).stat().st_size for f in written)


@pytest.mark.parametrize("name", NAMES)
def test_the_help_tells_what_the_command_does_and_each_option(name):
    """Catches an option that none tells of, no example, and `--no-x` that nobody asked for."""
    text = said(name, "--help")
    assert text.split("\n\n")[1] and re.search(rf"^ segmap {name}", text, re.MULTILINE)
    asked = APP[name].assemble_argument_collection(parse_docstring=True).filter_by(show=True)
    assert all(one.name in text and len(one.parameter.help) > 10 for one in asked)
    negative = set(re.findall(r"--(?:no|empty)-[\w-]+", text))
    assert negative <= {"--no-deskew", "--no-browser"}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_threshold_has_a_sentence_and_its_default(name):
    """Catches a threshold that a docstring forgot: nobody can tell what it does."""
    first, *rest = said("methods", name).splitlines()
    assert first.startswith(f"{name}: ") and len(first) > 30  # of its docstring
    for line in rest:
        key, words, default = re.fullmatch(r"  (\w+): (\S.*) Default: (.*)\.", line).groups()
        assert len(words) > 15 and words[0] == words[0].upper() and "As in" not in words
        if (name, key) == ("least_cost", "angle"):
            assert default == "5 degrees"


def test_quiet_is_silent_where_all_is_well(run):
    """Catches a line that a script has to throw away, and a fault that is hidden."""
    assert run("info", "room", "malaga", "-q") == (0, "", "")
    code, said, beside = run("info", "room", "gone.log", "--quiet")
    assert (code, said) == (1, "") and beside.startswith("segmap: gone.log: does not exist")
    assert run("info", "room", "-q", "--json")[1].startswith("{")


def test_tab_completes_commands_and_options(tmp_path):
    """Catches a script that is not installed, and options that Tab does not know."""
    home = os.environ | {"HOME": str(tmp_path), "SHELL": "/bin/bash"}
    command = [sys.executable, "-m", "segmap", "--install-completion"]
    subprocess.run(command, env=home, check=True, stdout=subprocess.DEVNULL)
    for line, word in (("segmap ma", "map"), ("segmap map malaga --squ", "--square")):
        words = f"COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))"
        script = f'. ~/.bashrc; {words}; _segmap; echo "${{COMPREPLY[@]}}"'
        told = subprocess.run(["bash", "-c", script], env=home, check=True, stdout=-1, text=True)
        assert word in told.stdout.split()
