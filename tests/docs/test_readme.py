"""The Python of the README runs as it stands there. This test needs only the library."""

import re
from pathlib import Path

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
