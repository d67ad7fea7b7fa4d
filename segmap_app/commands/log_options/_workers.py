"""One job a log, on the cores of this machine or on a Dask cluster: the same command elsewhere.

A worker that sees the folder of this command reads and writes there; to one that does not, the
bytes of the log go over the network, and those of what it wrote come back.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from segmap.display import pip_install, plural
from segmap.files import escape, write_bytes

from .._output import NO_MAP, Usage, print_error, print_line, progress, stop_early
from ._options import LogOptions
from ._program import FOR_ALL, JOB

#: What a job is: its words, the folder, and the bytes of its files where a worker sees none.
Job = tuple[list[str], str, dict[str, bytes] | None]


def on_workers(names: Sequence[str], given: LogOptions, chosen: list[list[str]]) -> int:
    """Do a command for each group of files on workers, and name at the end those that failed.

    A table grows as jobs end; logs that it holds already are not done again.
    """
    reading = given.reading
    table = Path(reading.table) if reading.table else None
    rows, failed, codes = read_table(table), list[str](), [0]
    done_before = {row["source"] for row in rows}
    waiting = [files for files in chosen if files[0] not in done_before]
    if len(waiting) < len(chosen):
        count = plural(len(chosen) - len(waiting), "log")
        print_line(f"{count} of {len(chosen)} done before: {escape(table)}")
    with ExitStack() as stack:
        stack.enter_context(stop_early())
        executor, client = stack.enter_context(_executor(str(reading.workers)))
        bar = stack.enter_context(progress(1 if reading.quiet else len(waiting), "log"))
        jobs = {
            executor.submit(run_elsewhere, *job): files[0]
            for files, job in zip(waiting, _jobs(names, given, waiting, client), strict=True)
        }
        for future in as_completed(jobs):
            code, row, written = _answer(future, source := jobs[future])
            codes.append(code)
            for name, content in written.items():
                write_bytes(Path(name), content)
            if "failed" in row:
                failed.append(row["failed"])
            else:
                rows.append(row)
            if table:
                write_table(table, rows)
            if reading.json:
                print_line(json.dumps(row))
            elif not reading.quiet and "failed" not in row:
                print_line(f"{escape(source)}: {row.get('verdict', {}).get('text', 'done')}")
            bar.update()
    for why in failed:
        print_error(why)
    if not (reading.json or reading.quiet):
        print_line(f"{len(waiting) - len(failed)} of {plural(len(waiting), 'log')} done")
    return 1 if failed else max(codes)


@contextmanager
def _executor(workers: str) -> Iterator[tuple[Executor, Any]]:
    """What runs jobs: so many at a time here, or a cluster, and then its client."""
    if workers.isdecimal():
        with ThreadPoolExecutor(int(workers)) as pool:  # each job is a process of its own
            yield pool, None
        return
    try:
        distributed: Any = import_module("dask.distributed")
    except ImportError:
        raise Usage(f"--workers ADDRESS needs dask: {pip_install('cluster')}") from None
    with distributed.Client(workers) as client:
        yield client.get_executor(pure=False), client


def _answer(future: Any, source: str) -> tuple[int, dict[str, Any], dict[str, bytes]]:
    """Exit code of a job, what it says of the log, or why it failed, and the files that it sent."""
    try:
        code, printed, errors, written = future.result()
    except Exception as error:  # of the worker, whatever it is: the others go on
        code, printed, written = 1, "", {}
        errors = f"its worker ended ({type(error).__name__})"
    row: dict[str, Any] = json.loads(printed.splitlines()[-1]) if printed.strip() else {}
    row["source"] = source
    if code not in (0, NO_MAP):
        last = [f"ended with {code}", *errors.strip().splitlines()][-1].removeprefix("segmap: ")
        why = row.get("failed", last)
        row["failed"] = why if escape(source) in why else f"{escape(source)}: {why}"
    return code, row, written


def run_elsewhere(
    words: list[str], folder: str, sent: dict[str, bytes] | None
) -> tuple[int, str, str, dict[str, bytes]]:
    """A command in a process of its own: exit code, output, errors, and what it wrote if sent."""
    command = [sys.executable, "-m", "segmap", *words]
    if sent is None:
        return *_run(command, folder), {}
    with tempfile.TemporaryDirectory() as empty:
        place = Path(empty)
        for name, content in sent.items():
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            (place / name).write_bytes(content)
        done = _run(command, empty)
        names = {str(path.relative_to(place)): path for path in _all_files(place)}
        written = {name: path.read_bytes() for name, path in names.items() if name not in sent}
    return *done, written


def _run(command: list[str], folder: str) -> tuple[int, str, str]:
    job = {**os.environ, JOB: "1"}
    done = subprocess.run(command, cwd=folder, env=job, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def _jobs(
    names: Sequence[str], given: LogOptions, waiting: list[list[str]], client: Any
) -> Iterator[Job]:
    """The words for each log, the folder, and the bytes of the log for who does not see it."""
    words, before, logs = list[str](), "", [*names]
    for word in given.words:
        if word in logs:
            logs.remove(word)
        elif before not in FOR_ALL and word.split("=")[0] not in FOR_ALL:
            words.append(word)
        before = word
    words += ["--json"] * (not given.reading.json)
    here = str(Path.cwd())
    paths = [[Path(name) for name in files if Path(name).exists()] for files in waiting]
    log_paths = [str(path.absolute()) for each in paths for path in each]
    if client is None or all(client.run(_sees, [here, *log_paths]).values()):
        yield from (([*words, *files], here, None) for files in waiting)
        return
    if any(Path(name).parent.name for name in given.output):
        raise Usage("the workers do not see this folder: -o must be a name without a folder")
    size = sum(
        each.stat().st_size for group in paths for path in group for each in _all_files(path)
    )
    print_line(f"the workers do not see {escape(here)}: {size / 1e6:.1f} MB of logs are sent")
    for files, group in zip(waiting, paths, strict=True):
        sent = {
            str(each.relative_to(path.parent)): each.read_bytes()
            for path in group
            for each in _all_files(path)
        }
        yield [*words, *([path.name for path in group] or files)], here, sent


def _sees(names: list[str]) -> bool:
    """Whether all files are where a worker looks."""
    return all(Path(name).exists() for name in names)


def _all_files(path: Path) -> list[Path]:
    """A file, or those below a folder."""
    return [each for each in (path, *sorted(path.rglob("*"))) if each.is_file()]


def write_table(path: Path, rows: Sequence[dict[str, Any]]) -> None:
    """A row for each log, a column for each figure: `aligned.matched` and so on."""
    import pandas as pd

    text = pd.json_normalize(list(rows)).convert_dtypes().to_csv(index=False)
    write_bytes(path, text.encode("utf-8", "backslashreplace"))


def read_table(path: Path | None) -> list[dict[str, Any]]:
    """The rows of a table that is there already, none where it is not."""
    import pandas as pd

    with suppress(FileNotFoundError, pd.errors.EmptyDataError):
        if path is not None:
            table: Any = pd.read_csv(path, dtype=str, keep_default_na=False)
            return [row for row in table.to_dict("records") if row.get("source")]
    return []
