"""The Python of the README runs as it stands there, and its overlay is that of its page."""

import re
from pathlib import Path

import yaml

import slippulse as sp

README = Path(__file__).resolve().parents[2] / "README.md"
# A block that is indented by four spaces, blank lines inside included.
BLOCK = re.compile(r"^    import slippulse.*\n(?:(?:    .*)?\n)*", re.MULTILINE)


def test_the_python_of_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = BLOCK.findall(README.read_text(encoding="utf-8"))
    assert blocks
    for block in blocks:
        names = {}
        exec("\n".join(line[4:] for line in block.splitlines()), names)
        assert (tmp_path / "run.png").stat().st_size > 10_000
        # The lattice is near the exact rupture.
        scene, run = names["scene"], names["run"]
        physics = scene.prestress, scene.gamma, scene.damping_ratio
        exact = sp.theory.Rupture(*physics, duration=scene.duration).transition
        assert abs(sp.measure(run)["transition_time"] - exact.time) < scene.dx


def test_the_overlay_of_a_stress_profile_is_that_of_its_page(project):
    block = re.search(
        r"^    scenes:\n(?:     .*\n)+", README.read_text(encoding="utf-8"), re.MULTILINE
    )
    page = (project / "docs/stress_profile.md").read_text(encoding="utf-8")
    overlay = re.search(r"^```yaml\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert block and overlay
    assert yaml.safe_load(block[0]) == yaml.safe_load(overlay[1])
