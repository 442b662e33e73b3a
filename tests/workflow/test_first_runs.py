"""Two first runs at once in a fresh clone."""

import subprocess

import pytest

pytestmark = [pytest.mark.workflow, pytest.mark.slow]
RUN = ["make", "replicate", "PRESET=draft", "TARGET=fig07"]


def test_of_two_first_runs_one_sets_up_and_one_runs(project, tmp_path):
    folder = tmp_path / "clone"
    subprocess.run(["git", "clone", "--quiet", project, folder], check=True)
    runs = [
        subprocess.Popen(RUN, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for _ in range(2)
    ]
    said = [run.communicate(timeout=500)[0] for run in runs]
    assert sum("Setting up" in text for text in said) == 1, said
    assert not any("Traceback" in text for text in said), said
    # The second may begin when the first has ended.
    refused = [text for run, text in zip(runs, said, strict=True) if run.returncode]
    assert len(refused) <= 1 and all("Another run is at work in this folder" in text for text in refused), (
        said
    )
    assert (folder / "results/figures/fig07_damage_zone.png").exists()
    assert subprocess.run(RUN, cwd=folder, check=False, timeout=100).returncode == 0
