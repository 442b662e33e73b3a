"""Comparison of two trees of results within their uncertainties."""

import json
import math
import shutil
from pathlib import Path

import pandas as pd
import pytest
from PIL import Image
from report.test_pages import check_accessible

from slippulse_paper.records.job_records import Record, file_digest, state_of, write_record
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


NAN, INF = math.nan, math.inf
ELASTIC, DRAFT = CONFIG | {"model": {"release": "elastic"}}, CONFIG | {"preset": "draft"}
DIFFERENT = [
    # The measured numbers are compared, whatever an older study has.
    ({}, {"speed": 1.03, "studied": 1.0}, "point 0, speed: new 1, old 1.03"),
    ({}, {"speed": 1.03}, "point 0, speed: new 1, old 1.03; allowed: a difference of 0.02"),
    ({}, {"run": {"left": -2.0}}, "sweep.csv: 1 pair of runs differs in left"),
    ({}, {"run": {"gamma": 0.3}}, "sweep.csv: 1 pair of runs differs in gamma"),
    (
        {},
        {"verdict": "not reproduced"},
        "speed: new verdict 'reproduced', old verdict 'not reproduced'",
    ),
    ({}, {"config": ELASTIC}, "model.release: new 'total', old 'elastic'"),
    # On one lattice everything agrees.
    ({"uncertainty": NAN}, {"speed": 1.5, "uncertainty": NAN}, "speed: new 1, old 1.5"),
    ({}, {"speed": NAN, "studied": 1.0}, "speed: new 1, old nan"),
    ({"pulse_state": "a"}, {"pulse_state": "b"}, "pulse_state: new 'a', old 'b'"),
    ({"run_flags": "energy"}, {"run_flags": ""}, "run_flags: new 'energy', old ''"),
    ({"friction_ratio": 5}, {"friction_ratio": 1}, "friction_ratio: new 5, old 1"),
    ({"width_at_end": 1.0}, {}, "sweep.csv: only one folder has the column width_at_end"),
    # An infinite number agrees only with an equal one.
    ({"speed": INF}, {"speed": INF}, "1 of 1 numbers agree"),
    ({"speed": INF}, {}, "speed: new inf, old 1; allowed: a difference of 0"),
    ({}, {"speed": INF}, "speed: new 1, old inf"),
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
    (lambda tree: shutil.copy(tree / TABLE, tree / OWN), "own.csv: only one folder has this table"),
    (
        lambda tree: (tree / "provenance.json").unlink(),
        "provenance.json: not compared, since one folder does not have it",
    ),
    (lambda tree: (tree / STUDY).unlink(), "sweep.csv: only one folder has uncertainties"),
    (
        lambda tree: shutil.rmtree(tree / "measurements"),
        "allowed: a folder of results that are finished",
    ),
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
    assert (result.compared, result.agree, result.unknown, result.disagreements) == (1, 0, 1, [])


def table_of(tree: Path, runs: list[dict]) -> None:
    """Replace the measured runs of a folder."""
    pd.DataFrame([RUN | {"dx": 0.01, "width_at_end": 1.0} | run for run in runs]).to_csv(
        tree / TABLE, index=False
    )


def test_runs_are_joined_by_their_parameters_in_any_order(tmp_path):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    table_of(here, [{"left": left, "speed": left} for left in (0.1, 0.2, 0.3)])
    table_of(other, [{"left": left, "speed": left} for left in (0.4, 0.3, 0.2)])
    result = compare(here, other)
    runs = result.runs[0]
    assert (runs.same_count, runs.altered_count) == (2, 1)
    assert runs.only_new == runs.only_old == []
    assert result.disagreements == [] and result.compared == result.agree == 4
    # What was altered is shown beside what it was, and is not judged.
    altered = result.numbers[result.numbers["outcome"] == "altered run"]
    assert {*altered["run"]} == {"left 0.1 (old: left 0.4)"}
    assert altered.set_index("quantity").loc["speed", ["new", "old"]].tolist() == [0.1, 0.4]


def test_runs_are_joined_if_one_table_has_only_whole_numbers(tmp_path):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    table_of(here, [{"left": left} for left in (1, 2)])
    table_of(other, [{"left": left} for left in (0.5, 1, 2)])
    result = compare(here, other)
    runs = result.runs[0]
    assert (runs.same_count, runs.only_new, runs.only_old) == (2, [], ["left 0.5"])
    # The text of a run has no old value that is equal to the new one.
    assert {*result.numbers["run"]} == {"left 1", "left 2"}


def test_runs_of_one_side_are_listed(tmp_path, capsys):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    table_of(here, [{"left": left, "gamma": 0.3} for left in (0.1, 0.2)])
    table_of(other, [{"left": left, "gamma": 0.5} for left in (0.1, 0.2, 0.3)])
    result = compare(here, other)
    runs = result.runs[0]
    assert runs.altered_count == 2 and runs.altered_parameters == ["gamma"]
    assert runs.only_old == ["left 0.3, gamma 0.5"] and runs.only_new == []
    assert main([str(here), str(other)]) == 1
    assert "sweep.csv: only in the old folder: left 0.3, gamma 0.5" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changes", "altered"),
    [({"duration": 20.0}, ["duration"]), ({"duration": 20.0, "gamma": 0.3}, ["gamma"])],
)
def test_the_duration_is_altered_if_nothing_else_explains_it(tmp_path, changes, altered):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    table_of(here, [{"left": left} | changes for left in (0.1, 0.2)])
    table_of(other, [{"left": left} for left in (0.1, 0.2)])
    runs = compare(here, other).runs[0]
    assert (runs.altered_count, runs.altered_parameters) == (2, altered)
    assert runs.only_new == runs.only_old == []


def test_spacings_of_a_convergence_study_are_not_mixed(tmp_path):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    table_of(here, [{"dx": dx, "speed": dx} for dx in (0.04, 0.02)])
    table_of(other, [{"dx": dx, "speed": dx} for dx in (0.02, 0.01, 0.04)])
    result = compare(here, other)
    assert result.disagreements == [] and result.unknown == 0 and result.runs[0].same_count == 2
    assert result.runs[0].only_old == ["dx 0.01"]


def test_the_page_has_old_beside_new(tmp_path, capsys):
    here = tree(tmp_path / "here", run={"gamma": 0.3}, speed=2.0, verdict="not reproduced")
    other = tree(tmp_path / "other", config=ELASTIC)
    for folder, names in ((here, ("fig01_one", "fig02_two")), (other, ("fig01_one",))):
        (folder / "figures").mkdir()
        for name in names:
            Image.new("RGB", (1500, 900)).save(folder / f"figures/{name}.png")
            (folder / f"figures/{name}.csv").write_text("x\n1\n")
    page = here / "compare.html"
    assert main([str(here), str(other), str(page)]) == 0
    assert f"Open {page}" in capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    outline = check_accessible(text)
    assert len(outline.all("img")) == 3
    assert all(image["src"].startswith("data:image/png") for image in outline.all("img"))
    assert {image["width"] for image in outline.all("img")} == {"1000"}
    for shown in ("model.release", "✓ reproduced", "× not reproduced", "New: not made"):
        assert shown in text.replace("Old: not made", "New: not made"), shown
    assert text.count("The old and the new figure show the same numbers.") == 1
    assert "gamma 0.3 (old: gamma 0.65)" in text and "altered run" in text
    numbers = pd.read_csv(here / "compare.csv")
    assert numbers.set_index("quantity").loc["speed", "old_uncertainty"] == 0.01


def test_the_page_shows_a_claim_of_one_folder(tmp_path):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    (here / "claims.json").write_text("[]")
    assert main([str(here), str(other), str(here / "compare.html")]) == 0
    text = (here / "compare.html").read_text(encoding="utf-8")
    assert "not judged" in text and "1 verdict changed" in text


def test_a_parameter_without_a_value_in_both_folders_is_not_altered(tmp_path):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    table_of(here, [{"left": 0.1, "width": NAN, "speed": 1.0}])
    table_of(other, [{"left": 0.2, "width": NAN, "speed": 1.0}])
    assert compare(here, other).runs[0].altered_parameters == ["left"]


def test_a_page_without_a_folder_and_a_broken_figure_are_refused(tmp_path, capsys):
    here, other = tree(tmp_path / "here"), tree(tmp_path / "other")
    assert main([str(here), str(other), str(tmp_path / "none/compare.html")]) == 1
    assert "none: no such folder" in capsys.readouterr().out
    (here / "figures").mkdir()
    (here / "figures/fig01_one.png").write_text("text")
    assert main([str(here), str(other), str(here / "compare.html")]) == 1
    assert "fig01_one.png: cannot be read" in capsys.readouterr().out


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


def test_verdicts_and_a_configuration_older_than_other_results_are_not_compared(tmp_path, capsys):
    """A run of one figure leaves them as they are, so that they say nothing about its results."""
    here, other = tree(tmp_path / "here", run={"gamma": 0.3}), tree(tmp_path / "other")
    for folder in (here, other):
        for step, output, name in (
            ("measure", TABLE, "../data/sweep.nc"),
            ("write_claims", "claims.json", TABLE),
            ("write_index", "provenance.json", "claims.json"),
        ):
            path = (folder / output).parent / name
            inputs = {name: file_digest(path)} if path.exists() else {}
            states = {Path(output).name: state_of(folder / output)}
            write_record(Record(step, "", "", states, inputs, 1.0), (folder / output).parent)
    page = here / "compare.html"
    lines = ("No verdict changed", "The two configurations are equal")
    assert main([str(here), str(other), str(page)]) == 0
    assert all(line in page.read_text(encoding="utf-8") for line in lines)
    # Measured again, but not judged again.
    (here / TABLE).write_text((here / TABLE).read_text().replace("1.0\n", "2.0\n"))
    states = {"sweep.csv": state_of(here / TABLE)}
    write_record(Record("measure", "", "", states, {}, 1.0), here / "measurements")
    assert main([str(here), str(other), str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert not any(line in text for line in lines)
    assert "The configuration was not compared" in text and "sweep: gamma" in text
    for name in ("claims.json", "provenance.json"):
        assert f"{here}/{name} is older than other results in that folder" in " ".join(text.split())
    printed = capsys.readouterr().out
    assert f"claims.json: not compared, since other results are newer than {here}" in printed
    check_accessible(text)
