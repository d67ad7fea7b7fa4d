"""The jail, part by part and without one: its words, and how an answer ends."""

import errno
import os
import re
import select
import stat
import struct
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from segmap_course.grading import _jail
from segmap_course.grading._filter import ALLOW, FAIL, KEPT_OUT, KILL, MACHINES, seccomp
from segmap_course.grading._jail import FONTS, Ended, Jail, Limits, Session, answers, readable

LIMITED = "prlimit --cpu=7:8 --as=1024 --nofile=64 --fsize=16777216 --core=0"
BEGIN = LIMITED + (
    " bwrap --unshare-all --unshare-user --disable-userns --cap-drop ALL --new-session --clearenv "
    "--die-with-parent --dev /dev --remount-ro /dev --size 16777216 --tmpfs /tmp --seccomp 9"
)
END = "--setenv HOME /tmp --setenv LANG C --chdir /tmp --remount-ro /"
HIDDEN = "--tmpfs {0}/segmap --remount-ro {0}/segmap --tmpfs {0}/course --remount-ro {0}/course"


@pytest.fixture
def jail(monkeypatch, tmp_path):
    """A jail of Python behind a link, and of a folder with a space; nothing is started."""
    packages = tmp_path / "real" / "here" / "segmap", tmp_path / "real" / "here" / "course"
    packages[0].mkdir(parents=True)
    (tmp_path / "py").symlink_to(tmp_path / "real")
    monkeypatch.setattr(_jail, "readable", lambda whole: ["/a lib", str(tmp_path / "py")])
    monkeypatch.setattr(_jail, "PACKAGES", packages)
    monkeypatch.setattr(_jail, "ENVIRONMENT", {"HOME": "/tmp", "LANG": "C"})
    monkeypatch.setattr(_jail.shutil, "which", str)
    monkeypatch.setattr(Jail, "_fault", lambda self: "")
    monkeypatch.setattr(sys, "executable", "/py/python")
    with Jail(Limits(1.0, 7, 1024)) as made:
        yield made


def test_a_jail_is_started_by_these_words(jail, monkeypatch, tmp_path):
    """Catches an option that is lost: each one of them keeps something out."""
    end = [*END.split(), "prlimit", "--nproc=1", "/py/python", "-I", "-c", "x"]
    py = str(tmp_path / "py")
    bound = ["--ro-bind", "/a lib", "/a lib", "--ro-bind", py, py]
    monkeypatch.setattr(_jail.os, "geteuid", lambda: 1)
    assert (str(jail), stat.S_IMODE(jail.folder.stat().st_mode)) == ("bubblewrap", 0o755)
    hidden = HIDDEN.format(f"{py}/here").split()
    start = ["sh", "-c", f'exec "$@" 9< {jail.folder}/filter', "sh", *BEGIN.split()]
    assert jail.command(["-c", "x"], whole=False) == [*start, *bound, *hidden, *end]
    course = str(Path(_jail.__file__).parent)
    own = ["--tmpfs", course, "--remount-ro", course]
    own += ["--ro-bind", str(jail.folder / FONTS), f"/tmp/{FONTS}"]
    assert jail.command(["-c", "x"], whole=True) == [*start, *bound, *own, *end]
    monkeypatch.setattr(_jail.os, "geteuid", lambda: 0)
    for _ in range(2):  # the folders are there the second time
        unshare, sets, shell, letter, script, *words = jail.command(["-c", "x"], whole=False)
    assert [unshare, sets, shell, letter] == ["unshare", "--mount", "sh", "-c"]
    first, second = (f"{jail.folder}/{k}" for k in (0, 1))
    assert script == (
        f"mount --bind '/a lib' {first} && mount --bind {py} {second} && "
        'exec setpriv --reuid=65534 --regid=65534 --clear-groups "$@" '
        f"9< {jail.folder}/filter"
    )
    bound = ["--ro-bind", first, "/a lib", "--ro-bind", second, py]
    assert words == ["sh", *BEGIN.split(), *bound, *hidden, *end]
    assert Path(first).is_dir() and Path(second).is_dir()


def test_without_a_jail_the_limits_stay(jail, monkeypatch):
    monkeypatch.setattr(Jail, "_fault", lambda self: "not here")
    with Jail(Limits(1.0, 7, 1024), unprotected=True) as bare:
        python = ["/py/python", "-I", "-c", "x"]
        assert str(bare) == "none" and bare.command(["-c", "x"], whole=True) == [
            *LIMITED.split(),
            *["prlimit", "--nproc=1"],
            *python,
        ]
        monkeypatch.setattr(_jail.shutil, "which", lambda name: None)
        assert bare.command(["-c", "x"], whole=False) == python
        folder = bare.folder
    assert not folder.exists()


@pytest.mark.parametrize(
    ("script", "why"),
    [
        ("echo '  no way  ' >&2; exit 3", "no way"),
        ("exit 3", "it fails"),
        ("printf 'x%0400d' 7 >&2; exit 3", f"{'0' * 299}7"),
    ],
)
def test_why_there_is_no_jail_is_said(script, why, monkeypatch, tmp_path):
    monkeypatch.setattr(_jail.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(_jail.shutil, "which", str)
    asked = []
    monkeypatch.setattr(
        Jail,
        "command",
        lambda self, *a, **k: asked.append((self.bare, a, k)) or ["sh", "-c", script],
    )
    with pytest.raises(ValueError, match=r"bubblewrap 0\.8") as refused:
        Jail()
    assert str(refused.value).partition("\n")[0].endswith(f"keep a student's code in: {why}.")
    assert list(tmp_path.iterdir()) == []
    assert asked == [(False, (["-c", "import numpy"],), {"whole": False})]
    monkeypatch.setattr(Jail, "command", lambda *a, **k: ["true"])
    with Jail() as made:
        assert not made.bare
    monkeypatch.setattr(_jail.shutil, "which", lambda name: None)
    with pytest.raises(ValueError, match=r"in: there is no bubblewrap\."):
        Jail()


def test_python_sees_its_packages_and_for_an_open_exercise_the_library(monkeypatch, tmp_path):
    folders = [tmp_path / name for name in ("b/site-packages", "a/dist-packages", "c/other")]
    for folder in folders:
        folder.mkdir(parents=True)
    lost = tmp_path / "d" / "site-packages"
    monkeypatch.setattr(sys, "path", [*map(str, folders), str(lost)])
    seen = readable(False)
    assert seen == sorted(seen) and {"/usr", sys.prefix} <= {*seen}
    assert {p for p in seen if p.startswith(str(tmp_path))} == {*map(str, folders[:2])}
    library, course = _jail.PACKAGES
    assert (library.name, course.name) == ("segmap", "segmap_course")
    known = [tmp_path / name for name in ("e/segmap", "e/data", "e/segmap/data", "f/course")]
    for folder in (*known, tmp_path / "f" / "data", tmp_path / "f" / "course" / "data"):
        folder.mkdir(parents=True, exist_ok=True)
    monkeypatch.setattr(_jail, "PACKAGES", (known[0], known[-1]))
    assert readable(True) == sorted([*seen, *map(str, known)])


def test_an_answer_may_take_so_much():
    """Catches a limit that grows by itself: 30 s, 10 s of computing, 3 GB; 8 MB, 200 kB of text."""
    from segmap_course.exercises import _exercise
    from segmap_course.grading import _grade, _report, _submissions

    assert Limits() == (30.0, 10, 3 * 1024**3)
    assert (_jail.MOST_BYTES, _jail.MOST_WRITTEN) == (8 * 1024**2, 16 * 1024**2)
    assert (_grade.MOST_CHARACTERS, _submissions.MOST_BYTES) == (200_000, 20_000_000)
    assert (_exercise.DRAWS, _report.ALIKE, _report.LEAST_MARKS) == (5, 0.9, 40)


# ------------------------------------------------------------------ system calls
def decided(program, audit, number):
    """What a filter says to a call, as the kernel runs it (seccomp(2))."""
    steps, at, held = list(struct.iter_unpack("HBBI", program)), 0, None
    while True:
        code, true, false, value = steps[at]
        at += 1
        if code == 0x06:
            return value
        if code == 0x20:
            held = {0: number, 4: audit}[value]
        else:
            at += true if {0x15: held == value, 0x25: held > value}[code] else false


@pytest.mark.parametrize("machine", MACHINES)
def test_the_filter_keeps_out_what_no_answer_needs(machine):
    """Catches a jump that ends elsewhere, a call that gets through, and another machine's call."""
    (audit, column), program = MACHINES[machine], seccomp(machine)
    out = {pair[column] for pair in KEPT_OUT.values()}
    for number in range(451):
        assert decided(program, audit, number) == (FAIL | errno.EPERM if number in out else ALLOW)
    for number in (451, 462, 1 << 30, (1 << 30) + 39, (1 << 32) - 1):
        assert decided(program, audit, number) == FAIL | errno.ENOSYS
    assert decided(program, 0x40000003, 26) == decided(program, audit ^ 1, 0) == KILL  # 32 bit


def test_a_machine_without_known_numbers_has_no_jail(monkeypatch):
    monkeypatch.setattr(_jail.shutil, "which", str)
    monkeypatch.setattr(_jail, "seccomp", lambda: seccomp("sparc64"))
    with pytest.raises(ValueError, match="in: the numbers of the system calls of sparc64 are not"):
        Jail()


@pytest.mark.parametrize(
    ("column", "file"),
    [(0, "x86_64-linux-gnu/asm/unistd_64.h"), (1, "asm-generic/unistd.h")],
)
def test_calls_have_the_numbers_of_the_kernel_s_headers(column, file):
    """Catches a number that is another call's."""
    header = Path("/usr/include") / file
    if not header.exists():
        pytest.skip("this system has no such header")
    known = dict(re.findall(r"define __NR(?:3264)?_(\w+)\s+(\d+)", header.read_text()))
    wrong = {
        name: pair
        for name, pair in KEPT_OUT.items()
        if int(known.get(name, pair[column])) != pair[column]
    }
    assert not wrong


# ------------------------------------------------------------------ how an answer ends


class Shell:
    """What a session starts in the place of Python in its jail."""

    def __init__(self, script, seconds=20.0):
        self.script, self.limits, self.folder = script, Limits(seconds, 7), Path("/")

    def command(self, python, *, whole):
        self.python, self.whole = python, whole
        return ["sh", "-c", self.script]


KILLED = "its process ended by signal 9: exit, kill, or too deep a recursion?"
SILENT = "its process ended before it answered: exit, kill, or too deep a recursion?"
COMPUTED = "stopped after 7 s of computing: an endless loop?"


@pytest.mark.parametrize(
    ("script", "kind", "reason"),
    [
        ("true", "ended", SILENT),
        ("exit 3", "ended", SILENT),
        ("exit 128", "ended", SILENT),
        ("exit 129", "ended", KILLED.replace("9", "1")),
        ("kill -9 $$", "ended", KILLED),
        ("exit 137", "ended", KILLED),
        ("kill -24 $$", "too long", COMPUTED),
        ("exit 152", "too long", COMPUTED),
        ("exec sleep 9", "too long", "stopped after 0.7 s: a loop that does not end?"),
        (
            "head -c 8388609 /dev/zero",
            "too much",
            "it answered with megabytes: return what the task says",
        ),
    ],
)
def test_why_there_is_no_answer_is_told_in_full(script, kind, reason):
    with Session(Shell(script, 0.7 if "sleep" in script else 20), whole=False) as session:
        with pytest.raises(Ended) as ended:
            session.ask("go")
        assert ended.value.args == (kind, reason)
        assert session.sent.closed == session.got.closed == False  # noqa: E712
    assert session.sent.closed and session.got.closed and session.process.returncode is not None


def test_each_line_has_its_answer(monkeypatch):
    """Catches a second line that is lost, another environment, and a reply that is no JSON."""
    monkeypatch.setenv("PATH", os.environ["PATH"] + ":/far")
    shell = Shell(
        'read -r a; printf "%s\\n\\"$HOME $MPLBACKEND ${PATH##*:} $PWD\\"\\nno\\n" "$a"; read b; '
        "head -c 300000 /dev/zero | tr '\\0' 7; echo"
    )
    with Session(shell, whole=True) as session:
        assert [session.ask(["ä", 1]) for _ in range(3)] == [["ä", 1], "/tmp Agg /far /", {}]
        assert session.ask(0) == {}, "a number without end"
    assert shell.whole and shell.python[0] == "-c" and "def decode" in shell.python[1]


def test_the_time_is_used_to_its_end(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(_jail, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    with Session(Shell("echo 1; exec sleep 5"), whole=False) as session:
        select.select([session.got], [], [], 20)
        clock[0] = 19.5
        assert session.ask(0) == 1
        clock[0] = 20.0
        with pytest.raises(Ended, match="stopped after 20 s"):
            session.ask(0)


def test_all_that_an_answer_started_ends_with_it(tmp_path):
    left = tmp_path / "left"
    with Session(Shell(f"(sleep 0.4; touch {left}) & echo 1; wait"), whole=False) as session:
        assert session.ask(1) == 1
    time.sleep(0.7)
    assert not left.exists()


@pytest.mark.parametrize(
    ("reply", "ended"),
    [
        ('["raised", "KeyError: 3"]', ("raised", "the cell itself raises KeyError: 3")),
        ('["syntax", "line 1"]', ("syntax", "the cell is not Python: line 1")),
        ('["missing", "it defines no f"]', ("missing", "it defines no f")),
        ('["memory", ""]', ("memory", "it asks for more memory than an answer may have")),
        (f'["missing", "{"x" * 600}"]', ("missing", "x" * 500)),
        ('["right", "x"]', ("no answer", "what came back is no answer")),
        ('["raised", "x", 3]', ("no answer", "what came back is no answer")),
        ("[1, 2]", ("no answer", "what came back is no answer")),
        ("3", ("no answer", "what came back is no answer")),
    ],
)
def test_a_fault_of_the_cell_is_told(reply, ended):
    job = {"cell": "x", "package": None}
    shell = Shell(f"read a; echo '{reply}'; exec sleep 5")
    with pytest.raises(Ended) as said:
        answers(shell, job, [])
    assert said.value.args == ended and shell.whole


def test_each_case_is_answered_by_its_own_line():
    """Catches an answer that moves to the next case, where one is no value; not reading too."""
    job = {"cell": "x", "package": ("", {})}
    shell = Shell("read a; echo null; read b; echo '[1, 2]'; read c; echo '{\"x\": 1}'; head -n 1")
    cases = [(1,), (2,), (3.5, "four")]
    assert answers(shell, job, cases) == [[1, 2], {}, (3.5, "four")] and not shell.whole
    deaf, begun = Shell("read a; echo null; exec sleep 40", 0.7), time.monotonic()
    with pytest.raises(Ended, match="too long"):
        answers(deaf, job, [("x" * 3_000_000,)])
    assert time.monotonic() - begun < 30
