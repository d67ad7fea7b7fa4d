"""Errors of alignment methods as a file keeps them, beside published ones."""

import pytest

from segmap.experiments import PUBLISHED, alignment_table, read_alignments

HEAD = "log,method,scans,used,compared,mean,deviation,rms,p95,largest,above_0.2,heading,seconds\n"
ROW = "intel,backbone,2672,1800,566,1.25,0.5,1.35,2.5,4.75,0.75,0.0625,12.5\n"


def written(folder, text):
    path = folder / "alignment.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_each_column_has_its_name(tmp_path):
    """Catches columns that are taken one for another: all values differ."""
    (run,) = read_alignments(written(tmp_path, HEAD + ROW))
    assert (run.log, run.method, run.scans, run.used, run.compared) == (
        *("intel", "backbone"),
        *(2672, 1800, 566),
    )
    assert (run.mean, run.deviation, run.rms, run.p95) == (1.25, 0.5, 1.35, 2.5)
    assert (run.largest, run.above, run.heading, run.seconds) == (4.75, 0.75, 0.0625, 12.5)


def test_a_table_shows_runs_and_published_results_and_no_seconds(tmp_path):
    """Catches times in a chapter's output, which no second run gives again."""
    runs = read_alignments(written(tmp_path, HEAD + ROW))
    text = repr(alignment_table([*runs, *PUBLISHED["intel"]]))
    assert "1800 of 2672" in text and "12.5" not in text
    assert text.splitlines()[1].split() == [
        *("backbone", "1.250", "0.500", "4.75", "1800", "of", "2672")
    ]
    assert text.splitlines()[4].split()[-4:] == ["0.031", "0.026", "-", "published"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: expected the head"),
        ("log,method\n", "line 1: expected the head log,method,scans"),
        (HEAD + ROW + "intel,odometry,2672\n", "line 3: expected an alignment"),
        (HEAD + ROW.replace("566", "many"), "line 2: expected an alignment, got .*many"),
    ],
)
def test_damaged_files_are_named(tmp_path, text, message):
    with pytest.raises(ValueError, match=rf"alignment.csv, {message}"):
        read_alignments(written(tmp_path, text))
