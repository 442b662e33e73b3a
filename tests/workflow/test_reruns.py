"""An alteration re-runs exactly what depends on it: dry runs in a copy that has just been finished."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
import yaml
from pipeline_copy import copy_project, planned, snakemake

pytestmark = pytest.mark.workflow

TARGETS = (
    "results/figures/fig07_damage_zone.png",
    "results/uncertainties/space_time_displacement.csv",
    "results/scenes/one.html",
    "results/scenes/one.gif",
    "results/scenes/data/two.csv",
)
KEPT = ("space_time_displacement", "space_time_stress")
SCENE = {
    "title": "One",
    "boundary": "displacement",
    "left": 0.5,
    "right": 0.6,
    "gamma": 0.65,
    "dx": 0.1,
    "duration": 6.0,
}
OVERLAY = {
    "preset": "draft",
    "simulations": {"space_time_displacement": {"duration": {"time": 5.0}, "samples": {"times": 11, "positions": 21}}},
    "scenes": {"one": SCENE, "two": SCENE | {"title": "Two", "left": 0.6, "right": 0.5}},
}  # fmt: skip
CHAIN = {"simulate": 1, "measure": 1, "study_grid": 1}
ONE = {"simulate_scene": 1, "measure_scene": 1, "study_grid_of_scene": 1, "draw_scene": 1, "animate_scene": 1}
# The second scene is asked for its measured numbers only.
BOTH = ONE | {"simulate_scene": 2, "measure_scene": 2}
MEASURED = {"measure": 1, "study_grid": 1, "measure_scene": 2, "study_grid_of_scene": 1, "draw_scene": 1}


@pytest.fixture(scope="module")
def finished(project, tmp_path_factory) -> Path:
    folder = copy_project(project, tmp_path_factory.mktemp("reruns"))
    # Without the simulations that are not asked for, each start checks less.
    shipped = yaml.safe_load((folder / "config/config.yaml").read_text(encoding="utf-8"))
    shipped["simulations"] = {name: shipped["simulations"][name] for name in KEPT}
    (folder / "config/config.yaml").write_text(yaml.safe_dump(shipped), encoding="utf-8")
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    result = snakemake(folder, "--quiet", "--", *TARGETS, overlay="overlay.yaml", cores=2)
    assert result.returncode == 0, result.stderr
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}
    return folder


def merged(base: dict, change: dict) -> dict:
    out = dict(base)
    for key, value in change.items():
        out[key] = merged(base[key], value) if isinstance(value, dict) and key in base else value
    return out


CONFIGURATIONS = {
    "another level": ({"simulations": {"space_time_displacement": {"left": [0.3]}}}, CHAIN),
    "another measure": (
        {"measure": {"front_window": 0.4}},
        MEASURED | {"fig07_damage_zone": 1},
    ),
    "another coarser lattice": (
        {"presets": {"draft": {"coarser": [1.5, 2.5]}}},
        {"study_grid": 1, "study_grid_of_scene": 1, "draw_scene": 1},
    ),
    "another release rule": ({"model": {"release": "elastic"}}, CHAIN | BOTH),
    "another damping": ({"model": {"damping_ratio": 0.2}}, CHAIN | BOTH | {"fig07_damage_zone": 1}),
    "another sketch": (
        {"figures": {"fig07_damage_zone": {"thickness_ratios": [0.3, 1.0]}}},
        {"fig07_damage_zone": 1},
    ),
    "another title": ({"scenes": {"one": {"title": "Uno"}}}, {"draw_scene": 1, "animate_scene": 1}),
    "swapped values": ({"scenes": {"one": {"left": 0.6, "right": 0.5}}}, ONE),
    "swapped scenes": ({"scenes": {"one": {"left": 0.6, "right": 0.5}, "two": {"left": 0.5, "right": 0.6}}}, BOTH),
    "what nobody asked for": ({"simulations": {"space_time_stress": {"left": [-0.5]}}}, {}),
    "permission for large sweeps": ({"allow_large": True}, {}),
}  # fmt: skip


@pytest.mark.parametrize("case", CONFIGURATIONS)
def test_another_configuration_runs_only_its_chain(finished, case):
    change, expected = CONFIGURATIONS[case]
    (finished / "changed.yaml").write_text(yaml.safe_dump(merged(OVERLAY, change)), encoding="utf-8")
    result = snakemake(finished, "--dry-run", "--", *TARGETS, overlay="changed.yaml")
    assert planned(result) == expected
    if expected:
        assert re.search(
            r"Params have changed|Missing output files|Set of input files has changed", result.stdout
        )


EVERY_DATA = {"compile_kernels": 1} | CHAIN | BOTH
EDITS = {
    "src/slippulse/figures/fig07_damage_zone.py": {"fig07_damage_zone": 1},
    "src/slippulse/figures/scene.py": {"draw_scene": 1},
    "src/slippulse/figures/scene_animation.py": {"animate_scene": 1},
    "src/slippulse/figures/style.py": {"fig07_damage_zone": 1, "draw_scene": 1, "animate_scene": 1},
    "src/slippulse/lattice/localised.py": EVERY_DATA,
    "src/slippulse/sweep.py": {key: count for key, count in EVERY_DATA.items() if key != "compile_kernels"},
    "src/slippulse/measure/fronts.py": MEASURED,
    "src/slippulse/claims/pulse.py": {},
    "requirements.lock": EVERY_DATA,
}  # fmt: skip


@pytest.mark.parametrize("source", EDITS)
def test_an_edit_runs_exactly_its_chain(finished, source):
    path = finished / source
    before, stat = path.read_bytes(), path.stat()
    try:
        path.write_bytes(before + b"\n# edited\n")
        result = snakemake(finished, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")
        assert planned(result) == EDITS[source]
        if EDITS[source]:
            assert f"Updated input files: {source}" in result.stdout
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
