"""Comparison of two trees of results within their uncertainties."""

import json
import math
import shutil
from pathlib import Path

import pandas as pd
import pytest

from slippulse_paper.report.compare import compare, main

RUN = {"boundary": "stress", "left": -1.0, "right": 0.0, "width": 1.0, "gamma": 0.65}
RUN |= {"damping_ratio": 0.1, "duration": 10.0, "release": "total"}
OWN = "measurements/own.csv"
TABLE, STUDY = "measurements/sweep.csv", "uncertainties/sweep.csv"
CONFIG = {"preset": "paper", "model": {"release": "total"}}
PLAIN = {"run": {}, "speed": 1.0, "uncertainty": 0.01, "verdict": "reproduced", "config": CONFIG}


def tree(folder: Path, **changes) -> Path:
    """Results with one measured number and further columns, and a grid study of it."""
    named = PLAIN | {key: changes.pop(key) for key in {*PLAIN} & {*changes}}
    run, speed, studied = RUN | named["run"], named["speed"], changes.pop("studied", named["speed"])
    folder = folder / "results"
    for name in ("measurements", "uncertainties"):
        (folder / name).mkdir(parents=True)
    lattice = {"scheme": "localised", "dx": 0.01, "order": 8, "max_step": 1.0, "speed": speed}
    pd.DataFrame([run | lattice | changes]).to_csv(folder / TABLE, index=False)
    study = {"quantity": "speed", "value": studied, "uncertainty": named["uncertainty"]}
    pd.DataFrame([{"point": 0} | run | study]).to_csv(folder / STUDY, index=False)
    (folder / "claims.json").write_text(json.dumps([{"id": "speed", "verdict": named["verdict"]}]))
    (folder / "provenance.json").write_text(json.dumps({"config": named["config"]}))
    return folder


NAN = math.nan
ELASTIC, DRAFT = CONFIG | {"model": {"release": "elastic"}}, CONFIG | {"preset": "draft"}
DIFFERENT = [
    # The measured numbers are compared, whatever an older study has.
    ({}, {"speed": 1.03, "studied": 1.0}, "point 0, speed: 1 against 1.03"),
    ({}, {"speed": 1.03}, "point 0, speed: 1 against 1.03; allowed: a difference of 0.02"),
    ({}, {"run": {"left": -2.0}}, "sweep.csv: other runs"),
    ({}, {"run": {"gamma": 0.3}}, "sweep.csv: other runs"),
    ({}, {"verdict": "not reproduced"}, "speed: verdict 'reproduced' against 'not reproduced'"),
    ({}, {"config": ELASTIC}, "model.release: 'total' against 'elastic'"),
    # On one lattice everything agrees.
    ({"uncertainty": NAN}, {"speed": 1.5, "uncertainty": NAN}, "speed: 1 against 1.5"),
    ({}, {"speed": NAN, "studied": 1.0}, "speed: 1 against nan"),
    ({"pulse_state": "a"}, {"pulse_state": "b"}, "pulse_state: 'a' against 'b'"),
    ({"run_flags": "energy"}, {"run_flags": ""}, "run_flags: 'energy' against ''"),
    ({"friction_ratio": 5}, {"friction_ratio": 1}, "friction_ratio: 5 against 1"),
    ({"width_at_end": 1.0}, {}, "sweep.csv: columns in one tree only: width_at_end"),
    # Numbers agree within both uncertainties, at any preset.
    *(({}, other, "1 of 1 numbers agree") for other in ({}, {"speed": 1.015}, {"config": DRAFT})),
]


@pytest.mark.parametrize(("one", "two", "said"), DIFFERENT)
def test_what_differs_is_said(tmp_path, capsys, one, two, said):
    code = main([str(tree(tmp_path / "here", **one)), str(tree(tmp_path / "there", **two))])
    assert said in capsys.readouterr().out and code == (0 if said.endswith("numbers agree") else 1)


CHANGED = pd.DataFrame([RUN | {"gamma": 0.3, "speed": 1.0}])
MISSING = [
    # A run of a single figure with another gamma leaves the old study of uncertainties.
    (lambda tree: CHANGED.to_csv(tree / TABLE, index=False), "0 of 0 numbers agree"),
    (lambda tree: shutil.copy(tree / TABLE, tree / OWN), "own.csv: in one tree only"),
    (lambda tree: (tree / "provenance.json").unlink(), "provenance.json: missing in one tree"),
    (lambda tree: (tree / STUDY).unlink(), "sweep.csv: uncertainties in one tree only"),
    (lambda tree: shutil.rmtree(tree / "measurements"), "allowed: a finished tree of results"),
]


@pytest.mark.parametrize(("change", "said"), MISSING)
def test_what_is_missing_in_one_tree_is_said(tmp_path, capsys, change, said):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    change(here)
    assert main([str(here), str(other)]) == 1
    assert said in capsys.readouterr().out


def test_a_number_without_uncertainty_is_unknown_on_another_lattice(tmp_path):
    here = tree(tmp_path / "here", uncertainty=NAN)
    result = compare(here, tree(tmp_path / "other", speed=2.0, uncertainty=NAN, dx=0.02))
    assert (result.compared, result.agree, result.unknown, result.apart) == (1, 0, 1, [])


TEXT = ",".join(RUN) + "\n" + ",".join(["x"] * len(RUN)) + "\n"
VALUE = "point,quantity,value,uncertainty\n0,speed,1x0,0.1\n"
ODD = {
    "other columns": (TABLE, "a,b\n1,2\n", "no column boundary"),
    "other columns in a study": (STUDY, "a,b\n1,2\n", "no column point"),
    "text for a width": (TABLE, TEXT, "text in column left"),
    "text for a value": (STUDY, VALUE, "text in column value"),
    "a folder for a table": (TABLE, None, "Is a directory"),
    "a folder for the provenance": ("provenance.json", None, "Is a directory"),
    "no configuration": ("provenance.json", "{}", "no 'config'"),
    "too deep": ("provenance.json", "[" * 100_000, ""),
    "claims without a name": ("claims.json", "[{}]", "no 'id'"),
    "a number for the claims": ("claims.json", "5", ""),
}


@pytest.mark.parametrize("which", ["here", "there"])
@pytest.mark.parametrize("case", ODD)
def test_an_odd_tree_is_refused_in_one_line(tmp_path, capsys, case, which):
    name, text, said = ODD[case]
    trees = {side: tree(tmp_path / side) for side in ("here", "there")}
    path = trees[which] / name
    path.unlink()
    path.mkdir() if text is None else path.write_text(text)
    assert main([str(trees["here"]), str(trees["there"])]) == 1
    printed = capsys.readouterr().out
    assert printed.startswith(f"{path}: cannot be read (")
    assert said in printed and printed.count("\n") == 1
