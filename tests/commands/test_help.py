"""What commands say of themselves: the short help, the long one, and that of one method."""

import json
import re
import shlex
import shutil
import subprocess
from itertools import pairwise

import pandas as pd
import pytest
from conftest import slow

from segmap import alignment, extraction, reduction
from segmap._commands._main import parser

FUNCTIONS = {
    name: getattr(method, "function", method)
    for room in (alignment, extraction, reduction)
    for name, method in room.METHODS.items()
}

#: What a command that is run as its help shows it waits for: a browser, a sensor.
WAITS = {"app", "sensor info", "sensor record"}
NAMES = [name for action in parser()._actions for name in getattr(action, "choices", None) or ()]


def examples_of(command):
    """The lines below `examples:`, without `segmap`, and without what is said of them."""
    lines = command.epilog.partition("examples:\n")[2].splitlines()
    return [re.split(r"\s{3,}", line.strip())[0].removeprefix("segmap ") for line in lines]


@pytest.mark.parametrize("name", [slow(n) if n in ("compare", "warm") else n for n in NAMES])
def test_examples_run_as_they_stand_one_after_the_other(run, tmp_path, commands, name):
    """Catches an example that needs a file which nobody has, and an option that is gone."""
    examples = examples_of(commands[name])
    assert sum(line.split()[0] == name for line in examples) >= 3
    for line in examples:
        words = shlex.split(line)
        parser().parse_args(words)
        if not WAITS & {words[0], " ".join(words[:2])}:
            assert run(*words)[0] == 0, line
            written = [file for flag, file in pairwise(words) if flag in ("-o", "--table")]
            assert all((tmp_path / f.replace("{name}", "room")).stat().st_size for f in written)


#: A shell asks so for what may follow the words that it is given.
ASKED = """\
COMP_WORDS=(segmap "$@"); COMP_CWORD=$#
_segmap
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def commands():
    (found,) = (a.choices for a in parser()._actions if isinstance(a.choices, dict))
    return found


def test_the_short_help_fits_on_a_screen_and_has_examples(commands):
    """Catches a command whose help nobody reads to its end, and one without an example."""
    for name, command in commands.items():
        said = command.format_help()
        assert said.count("\n") <= 60, name
        assert re.search(rf"^  segmap {name}", said, re.MULTILINE), name
        assert command.description.endswith((".", ".\n")), name


def test_an_option_is_told_or_named_in_the_short_help_and_told_in_the_long_one(commands):
    """Catches an option that no help tells of: thresholds are told method by method."""
    for name, command in commands.items():
        short, long = command.format_help(), command.format_all()
        for action in command._actions:
            if action.help != "==SUPPRESS==":
                assert action.help, (name, action.dest)
                assert all(option in short for option in action.option_strings[:1]), name
        for group in command.methods.values():
            assert all(action.option_strings[0] in long for action in group._group_actions)


def test_each_threshold_has_a_sentence_a_unit_and_its_default(commands):
    """Catches a threshold that a docstring forgot: nobody can tell what it does."""
    told = commands["map"].methods
    assert set(told) == set(FUNCTIONS)
    for name, group in told.items():
        assert len(group.description) > 30, name  # the first line of the docstring
        for action in group._group_actions:
            words, _, default = action.help.rpartition(" Default: ")
            assert len(words) > 15 and words[0] == words[0].upper(), (name, words)
            assert "As in" not in words and default.endswith("."), (name, words)
    (angle,) = (a for a in told["least_cost"]._group_actions if a.dest == "angle")
    assert (angle.metavar, angle.help.rpartition("Default: ")[2]) == ("DEGREES", "5 degrees.")
    (chi2,) = (a for a in told["weighted_line_fitting"]._group_actions if a.dest == "chi2")
    assert "holds 99 % of looks" in commands["map"].format_method("weighted_line_fitting")
    assert chi2.help.endswith("Default: 9.21.")


def test_help_of_a_method_is_asked_for_by_its_name(run):
    """Catches a word after --help that is taken for a log."""
    code, said, _ = run("map", "--help", "fusion")
    assert code == 0 and said.startswith("fusion:\n  Replace chains of segments")
    assert "  --tolerance METRES  Half width of the strip." in said
    assert "  It has no threshold." in run("map", "-h", "odometry")[1]
    assert len(run("map", "--help-all")[1]) > 5 * len(run("map", "--help")[1])
    assert run("info", "--help")[0] == 0


def test_quiet_is_silent_where_all_is_well(run):
    """Catches a line that a script has to throw away, and a fault that is hidden."""
    assert run("info", "room", "malaga", "-q") == (0, "", "")
    code, said, beside = run("info", "room", "gone.log", "--quiet")
    assert (code, said) == (1, "") and beside.startswith("segmap: gone.log: does not exist")
    assert run("info", "room", "-q", "--json")[1].startswith("{")


def test_info_holds_numbers_that_a_table_can_sort(run, tmp_path):
    """Catches a figure that is only a text: fifty logs cannot be put in an order by it."""
    code, said, _ = run("info", "malaga", "room", "--json", "--table", "it.csv")
    malaga, room = map(json.loads, said.splitlines())
    assert code == 0 and (malaga["scans"]["scans"], room["scans"]["scans"]) == (225, 61)
    assert malaga["scans"]["seconds"] == pytest.approx(59.1, abs=0.05)
    assert malaga["beams"]["least"] == malaga["beams"]["most"] == 361
    assert malaga["beams"]["valid"] == pytest.approx(0.885, abs=5e-4)
    assert (malaga["view"]["degrees"], malaga["view"]["step_degrees"]) == (180, 0.5)
    assert malaga["ranges"]["median"] == pytest.approx(8.58, abs=0.005)
    assert malaga["truth"]["poses"] == 99
    assert malaga["odometry"]["metres"] == pytest.approx(76.4, abs=0.05)
    table = pd.read_csv("it.csv").sort_values("odometry.metres")
    assert list(table["log"]) == ["room", "malaga"]


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_a_shell_offers_commands_options_methods_and_logs(run, tmp_path, shell):
    """Catches a script that no shell reads, a shortened list, and a file's name that is cut."""
    if not shutil.which(shell):
        pytest.skip(f"there is no {shell}")
    code, script, _ = run("--completion")
    (tmp_path / "script").write_text(script)
    (tmp_path / "own log.npz").touch()

    def offered(*words):
        zsh = shell == "zsh"
        text = f"source ./script; {'setopt ksharrays shwordsplit' if zsh else ''}\n{ASKED}"
        done = subprocess.run(
            [shell, "-c", text, shell, *words], capture_output=True, text=True, timeout=60
        )
        assert (done.returncode, done.stderr) == (0, "")
        found = (
            done.stdout.splitlines()
        )  # zsh asks for all, and itself leaves out what does not fit
        return [word for word in found if word.startswith(words[-1])] if zsh else found

    assert code == 0 and offered("m") == ["map", "merge"]
    assert offered("--comp") == ["--completion"]
    assert set(offered("map", "room", "--method", "")) == {*reduction.METHODS, "none"}
    assert offered("map", "--help", "back") == ["backbone"]
    assert offered("map", "room", "--toler") == ["--tolerance"]
    assert "--tolerance" not in offered("info", "room", "--")
    assert offered("map", "o") == ["own log.npz"] and offered("merge", "m") == ["malaga"]
    assert offered("sensor", "") == ["list", "info", "record"]
