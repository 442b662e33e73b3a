"""The recipe for a new term of the equation (CONTRIBUTING.md), applied to a copy of the sources."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import dedent, indent

import pytest

from slippulse.model.scene import EXTRA_TERMS

pytestmark = pytest.mark.skipif("foundation" in EXTRA_TERMS, reason="the sources have the term")
LAST_FIELD = "    friction: Friction = COULOMB\n"
# The interpreter runs the kernels of the copy, because compiling them would take a minute.
SETTINGS = {"NUMBA_DISABLE_JIT": "1"}

EQUATION = """
    import slippulse as sp

    profile = sp.Prestress(0.5, 0.5)
    for scheme in ("localised", "fixed_step"):
        lattice = {"dx": 0.25, "beta": 0.025, "max_step": 0.1, "scheme": scheme}
        held = sp.Scene("displacement", profile, 2.0, gamma=0.65, **lattice)
        springs = sp.Scene("stress", profile, 2.0, foundation=0.65, **lattice)
        slip = sp.simulate(held)["slip"]
        assert slip.max() > 1.0 and slip.equals(sp.simulate(springs)["slip"])
        assert held.largest_stable_step == springs.largest_stable_step
"""
DATA = """
    import numpy as np
    import pytest

    import slippulse as sp
    from slippulse.data.variables import VARIABLES
    from slippulse.prediction.comparison import measured_row

    same = {"boundary": "displacement", "gamma": 0.65, "left": 0.5, "dx": 0.25, "beta": 0.02}
    sweep = sp.sweep(**same, duration=6.0, record=("fronts", "fields"), foundation=[0.0, 0.3])
    assert sp.as_grid(sweep)["first_stick_time"].sizes == {"foundation": 2}
    assert sweep["foundation"].attrs["long_name"] == VARIABLES["foundation"]
    without, with_term = (sp.point(sweep, i) for i in range(2))
    assert sp.Scene.from_attributes(with_term.attrs).foundation == 0.3
    table = sp.measure(sweep)
    assert table["foundation"].tolist() == [0.0, 0.3]
    of_paper = ["pulse_stress_drop", "paper_transition_time", "paper_transition_length"]
    assert table.loc[0, of_paper].notna().all() and table.loc[1, of_paper].isna().all()
    assert table["pulse_state"].tolist()[1] == "none" != table["pulse_state"].tolist()[0]
    # A file from before the change.
    del without.attrs["foundation"]
    assert sp.Scene.from_attributes(without.attrs).foundation == 0.0
    assert sp.measure(without)["foundation"] == 0.0
    for wrong in ({"foundation": -1.0}, {"foundation": 0.3, "scheme": "continuum"}):
        with pytest.raises(ValueError, match="^foundation: .*; allowed: "):
            sp.Scene("stress", sp.Prestress(0.5, 0.5), 2.0, 0.25, **wrong)
"""
SWEEP = """
    from pathlib import Path

    import pytest
    import yaml

    from slippulse.prediction.measured_run import MEASURE_SETTINGS
    from slippulse_paper.configuration.expand import expand
    from slippulse_paper.configuration.read import ConfigError, read_config
    from slippulse_paper.configuration.refusals import json_schema
    from slippulse_paper.configuration.resolve import accuracy_of, all_simulations, resolve
    from slippulse_paper.configuration.runs import runs
    from slippulse_paper.report.texts import parameters
    from slippulse_paper.steps.predict import predictions

    shipped = yaml.safe_load(Path("config/config.yaml").read_text(encoding="utf-8"))
    small = {"boundary": "displacement", "duration": {"time": 5.0}, "record": ["fronts"]}
    small |= {"left": [0.5], "right": "same", "gamma": [0.65]}
    scene = {"title": "A", "boundary": "stress", "left": 0.5, "right": 0.5, "duration": 5.0}


    def read(values, **others):
        sweeps = {"mine": small | {"foundation": values}}
        return read_config(shipped, [{"simulations": sweeps, **others}])


    config = read([0.0, 0.3], scenes={"one": scene | {"foundation": 0.2}})
    simulations = all_simulations(config)
    mine, one = (
        resolve(simulations[name], config.model, accuracy_of(config)) for name in ("mine", "one")
    )
    assert [scene.foundation for scene in expand(mine)[0]] == [0.0, 0.3]
    assert [scene.foundation for scene in expand(one)[0]] == [0.2]
    table = predictions(("front", "pulse"), [*runs(mine)], MEASURE_SETTINGS)
    assert table.loc[0].notna().any() and table.loc[1].isna().all()
    assert "$\\\\kappa$ = 0 and 0.3" in parameters(config.plain(), "mine")
    assert json_schema()["$defs"]["NamedScene"]["properties"]["foundation"]
    for values, others in (([-0.1], {}), (0.3, {}), ([0.0, 0.3], {"accuracy": 0.01})):
        with pytest.raises(ConfigError, match=r"simulations\\.mine\\.foundation"):
            read(values, **others)
"""


@pytest.fixture(scope="module")
def changed_sources(project: Path, tmp_path_factory) -> Path:
    """Sources with the edits of the recipe."""
    sources = tmp_path_factory.mktemp("recipe") / "src"
    shutil.copytree(project / "src", sources, ignore=shutil.ignore_patterns("__pycache__"))
    recipe = (project / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipe = recipe.partition("## Change the equation of motion")[2].partition("\n## ")[0]
    field, _ = re.findall(r"   ```python\n(.*?)   ```", recipe, re.DOTALL)
    field = indent(dedent(field), "    ")
    edits = [(LAST_FIELD, LAST_FIELD + field), *re.findall(r"   -(.*?),?\n   \+(.*?),?\n", recipe)]
    files = ("model/scene.py", "model/scene.py", "solver/lattice.py")
    for file, (old, new) in zip(files, edits, strict=True):
        path = sources / "slippulse" / file
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == 1
        path.write_text(text.replace(old, new), encoding="utf-8")
    return sources


@pytest.mark.parametrize("code", [EQUATION, DATA, SWEEP], ids=["equation", "data", "sweep"])
def test_a_term_that_is_defined_once_is_known_everywhere(code, changed_sources, project):
    environment = os.environ | SETTINGS | {"PYTHONPATH": str(changed_sources)}
    command = [sys.executable, "-c", dedent(code)]
    result = subprocess.run(
        command, cwd=project, env=environment, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
