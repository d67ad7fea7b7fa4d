"""`--workers`: one job a log, on the workers of a Dask cluster."""

import csv
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

from segmap.readers import data_file


def command(*words, folder):
    """`segmap` with these words, in a process of its own."""
    run = [sys.executable, "-m", "segmap", *words]
    return subprocess.Popen(run, cwd=folder, stdout=-1, stderr=-1, text=True)


@contextmanager
def cluster_of(workers, folder):
    """A client of a cluster of so many workers."""
    distributed = pytest.importorskip("distributed")
    options = {"dashboard_address": "127.0.0.1:0", "local_directory": str(folder)}
    with (
        distributed.LocalCluster(n_workers=workers, threads_per_worker=1, **options) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def rows(table):
    return list(csv.DictReader(table.read_text().splitlines())) if table.exists() else []


def logs_in(folder, names):
    (folder / "logs").mkdir(parents=True)
    for name in names:
        shutil.copy(data_file("room/room.log.gz"), folder / "logs" / f"{name}.log.gz")


def test_a_worker_that_dies_and_a_log_that_is_none_leave_the_others(tmp_path):
    """Catches a run that ends with its first fault, a table that is written at the end alone, and
    work that is done twice."""
    logs_in(tmp_path, "abcd")
    (tmp_path / "logs" / "e.log.gz").write_bytes(b"\x1f\x8bnothing")
    table = tmp_path / "t.csv"
    words = ("map", "logs", "--workers", "{}", "--table", "t.csv", "-o", "{name}.svg")
    with cluster_of(2, tmp_path / "dask") as client:
        words = [word.format(client.scheduler.address) if word == "{}" else word for word in words]
        run = command(*words, folder=tmp_path)
        end = time.monotonic() + 120
        while not rows(table) and time.monotonic() < end:
            time.sleep(0.05)
        assert 0 < len(rows(table)) < 4, "a table that grows"
        victim = next(iter(client.run(os.getpid).values()))
        os.kill(victim, signal.SIGKILL)
        out, errors = run.communicate(timeout=240)
        assert run.returncode == 1 and "4 of 5 logs done" in out
        assert errors.count("segmap: ") == 1 and "e.log.gz" in errors
        found = rows(table)
        assert sorted(row["log"] for row in found) == [*"abcd"]
        assert all(row["verdict.text"].startswith("GOOD") for row in found)
        assert {path.name for path in tmp_path.glob("*.svg")} == {f"{k}.svg" for k in "abcd"}
        again = command(*words, folder=tmp_path)
        out, errors = again.communicate(timeout=240)
        assert "4 logs of 5 done before: t.csv" in out and "0 of 1 log done" in out
        assert rows(table) == found
