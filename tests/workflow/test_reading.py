"""A job records what it read when it read it, and fails if that is not what was planned."""

import subprocess
import sys
from pathlib import Path

import pytest
from pipeline_copy import BY_PROFILE, SNAKEMAKE, copy_project, refused
from slippulse_paper.steps.processes import JobFailed, Jobs

from slippulse.data.files import write_text
from slippulse_paper.records.job_records import Origin, file_digest, read_record, write_record

FIGURE = "results/figures/fig07_damage_zone.png"
# A job that reads a file while it is another one, and puts it back.
PROGRAM = """
import subprocess
from pathlib import Path
from slippulse_paper.records.job_records import file_digest
from slippulse_paper.steps import reading

reading.begin()
path, planned = Path("results/text"), {{}}
path.write_text("as planned")
planned["results/text"] = file_digest(path)
for text in ("as planned", "edited"):
    try:
        with reading.expected(planned):
            path.write_text(text)
            {read}
            path.write_text("as planned")
        print("read", text)
    except reading.FileChanged as error:
        print(error)
"""
WAYS = {
    "bytes": "path.read_bytes()",
    "a table": "import pandas; pandas.read_csv(path)",
    "another program": "subprocess.run(['cat', 'results/text'], stdout=subprocess.DEVNULL)",
}


@pytest.mark.parametrize("way", WAYS)
def test_a_file_that_was_edited_while_it_was_read_is_told(tmp_path, way):
    (tmp_path / "results").mkdir()
    command = [sys.executable, "-c", PROGRAM.format(read=WAYS[way])]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    changed = "results/text: changed since its job wrote it; run again"
    assert said.splitlines() == ["read as planned", changed]


def test_a_result_that_was_altered_since_its_job_wrote_it_fails_the_job_that_reads_it(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    table = Path("results/a.csv")
    write_text("a\n1\n", table)
    write_record(Origin(("a.csv",), "measure", "", "", {}), {}, {})
    origin = Origin(("b.csv",), "join", "", "", {"a.csv": "records/a.csv.json"})
    files = {"chunks": ["results/a.csv"]}, {"joined": "results/b.csv"}
    job = (origin, "join b.csv", *files, {"kind": "measured"}, "results/logs/b.log")
    jobs = Jobs()
    jobs.run(*job)
    record = Path("results/records/b.csv.json")
    assert read_record(record).inputs == {"a.csv": file_digest(table)}
    record.unlink()
    table.write_text("a\n2\n")
    with pytest.raises(
        JobFailed, match=r"\AFileChanged: results/a.csv: changed since its job wrote it"
    ):
        jobs.run(*job)
    assert not record.exists()


@pytest.mark.parametrize(
    ("source", "command"),
    [
        ("figures/fig07_damage_zone.py", SNAKEMAKE),
        pytest.param("figures/style.py", BY_PROFILE, marks=pytest.mark.slow),
    ],
)
def test_a_source_that_was_edited_while_a_run_was_at_work_fails_its_job(
    project, tmp_path, source, command
):
    """The edit comes after the plan, and is undone once the job has loaded it."""
    folder = copy_project(project, tmp_path / "copy")
    path = folder / "src/slippulse" / source
    text = path.read_text(encoding="utf-8")
    undo = f"\n__import__('pathlib').Path(__file__).write_text({text!r}, encoding='utf-8')\n"
    edit = f"\n__import__('pathlib').Path({str(path)!r}).write_text({text + undo!r})\n"
    libraries = folder / "src/slippulse_paper/steps/libraries.py"
    libraries.write_text(libraries.read_text(encoding="utf-8") + edit, encoding="utf-8")
    said = refused(folder, "--", FIGURE, command=command).strip().splitlines()
    reason = f"FileChanged: src/slippulse/{source}: changed since this run was planned; run again"
    details = " (details: results/logs/fig07_damage_zone.traceback)"
    # The logger of the profile writes in a thread, and may have the last word.
    assert reason + details in (said if command is BY_PROFILE else said[-1:])
    assert path.read_text(encoding="utf-8") == text
    # The next run makes what has no record.
    assert not Path(folder, f"results/records/{FIGURE.removeprefix('results/')}.json").exists()
