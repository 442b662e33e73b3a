"""Every file of the package and of the report's texts marks the rules whose step reaches it, and no others; an
alteration runs exactly what depends on it. What depends on what is found from the imports, not from the rules. And
what a target needs, what the default makes, what the README shows.
"""

import html
import os
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import grimp
import pytest
import yaml
from pipeline_copy import BY_PROFILE, OVERLAY, copy_project, edges, planned, snakemake
from workflow.conftest import TARGETS

from slippulse.steps.predict import TOPICS
from slippulse.steps.reach import declared, sources

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE, TEXTS = PROJECT / "src/slippulse", PROJECT / "manuscript"
# Rules whose step takes a module by name: one a figure, one a study of the solver.
DRAWN = {
    path.stem
    for pattern in ("fig*.py", "study_*.py")
    for path in (PACKAGE / "figures").glob(pattern)
}
STUDIED = {
    f"study_of_{path.stem}": path.stem
    for path in (PACKAGE / "studies").glob("*.py")
    if re.search(r"^NEEDS = ", path.read_text(encoding="utf-8"), re.M)
}
# Every other step has a rule, but what the steps share; two schemes take other steps of the same rules.
NO_RULES = {
    "__init__",
    "inputs",
    "job",
    "libraries",
    "reach",
    "targets",
    "draw_figure",
    "run_study",
}
STEPS = {path.stem for path in (PACKAGE / "steps").glob("*.py")} - NO_RULES
STEPS = {step for step in STEPS if not step.endswith(("_continuum", "_fixed_step"))}
# Modules that a rule runs.
MODULES = {
    **{step: [f"steps.{step}"] for step in STEPS},
    **{name: ["steps.draw_figure", f"figures.{name}"] for name in DRAWN},
    **{rule: ["steps.run_study", f"studies.{study}"] for rule, study in STUDIED.items()},
    "sweep_mine": ["steps.draw_figure", "figures.user_defined_sweep"],
    "predict": ["steps.predict", *(f"predict.{topic}" for topic in TOPICS)],
}
RULES = {*MODULES}
# The templates that pages begin with, by the rules that write them.
PAGES_OF = {f"write_{name}": [f"{name}.html"] for name in ("claims", "explorer", "index")}
PAGES_OF |= {"write_report": ["report.html", "report.typ"]}
PAGES_OF |= {"draw_scene": ["scene.html"], "write_scenes_page": ["scenes.html"]}
# Texts beside the package, by the rules that read them; all others only the report reads.
READ_BY = {
    "captions.yaml": {"write_report", "write_index"}, "summary.yaml": {"write_report", "write_index"},
    "claims.yaml": {"write_report", "write_claims"}, "statements.yaml": {"write_report", "write_claims"},
    "open_choices.yaml": {"study_of_open_choices"},
}  # fmt: skip
# Rules that only name targets.
NAMES = {"all", *TARGETS}
# Notes a digest of every source.
EVERY_SOURCE = {"write_provenance"}
FILES = sorted(
    path.relative_to(PROJECT).as_posix()
    for folder in (PACKAGE, TEXTS)
    for path in folder.rglob("*")
    if path.is_file() and "__pycache__" not in path.parts
)


def module_file(name: str) -> str:
    path = f"src/{name.replace('.', '/')}"
    return f"{path}/__init__.py" if (PROJECT / path).is_dir() else f"{path}.py"


@cache
def imports() -> grimp.ImportGraph:
    """What imports what, the packages that a module is in included."""
    graph = grimp.build_graph("slippulse", cache_dir=None)
    # What is taken from a package that loads as it goes may be in any of its modules.
    for name in graph.modules - {"slippulse"}:
        if "def __getattr__(" in (PROJECT / module_file(name)).read_text(encoding="utf-8"):
            for user in graph.find_modules_that_directly_import(name):
                for inside in graph.find_descendants(name):
                    graph.add_import(importer=user, imported=inside)
    for name in graph.modules - {"slippulse"}:
        graph.add_import(importer=name, imported=name.rpartition(".")[0])
    return graph


@cache
def templates_of(page: str) -> set[str]:
    """A template and those that it is made with."""
    path = f"src/slippulse/report/templates/{page}"
    text = (PROJECT / path).read_text(encoding="utf-8")
    return {path}.union(
        *map(templates_of, re.findall(r'{% (?:extends|include|import) "(.+?)"', text))
    )


@cache
def expected(rule: str) -> set[str]:
    """Files of the package and texts that a rule depends on."""
    modules = {f"slippulse.{name}" for name in MODULES[rule]}
    found = {
        module_file(name) for name in modules.union(*map(imports().find_upstream_modules, modules))
    }
    found.update(*map(templates_of, PAGES_OF.get(rule, ())))
    texts = {
        path.name for path in TEXTS.iterdir() if rule in READ_BY.get(path.name, {"write_report"})
    }
    return found | {f"manuscript/{name}" for name in texts}


@cache
def rules_of(file: str) -> set[str]:
    """Rules that an edit of a file of the sources marks."""
    return {rule for rule in RULES if file in expected(rule)} | EVERY_SOURCE


@pytest.fixture(scope="module")
def linked(tmp_path_factory) -> Path:
    """A copy of the project's sources, with a space and an umlaut in its path, and an overlay."""
    folder = copy_project(PROJECT, tmp_path_factory.mktemp("a copy für tests"), link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def inputs(linked) -> dict[str, set[str]]:
    """Files that each rule takes, from one look of Snakemake at everything."""
    targets = (*TARGETS, "results/predictions/mine.csv")
    result = snakemake(linked, "--forceall", "--filegraph", "--", *targets, overlay="overlay.yaml")
    assert result.returncode == 0, result.stderr
    found = {}
    entry = r'point-size="18">(\w+)</font>(.*?)(?=point-size="18"|\Z)'
    for name, text in re.findall(entry, result.stdout, re.S):
        taken = text.partition("&#8618; input")[2].partition("output &rarr;")[0]
        found[name] = {html.unescape(file) for file in re.findall(r'"monospace">([^<]+)<', taken)}
    return found


@pytest.fixture(scope="module")
def seen(inputs) -> dict[str, set[str]]:
    """Sources that each rule depends on: what its modules reach, and the texts that it takes."""
    return {
        name: {file for file in files if not file.startswith(("results/", "<"))}
        | {*sources(*MODULES[name])}
        for name, files in inputs.items()
        if name not in NAMES
    }


def test_every_file_marks_the_rules_whose_step_reaches_it(seen):
    # One a step, a figure and a study.
    assert set(seen) == RULES
    marked = {file: {rule for rule, inputs in seen.items() if file in inputs} for file in FILES}
    # The rules that are too many or missing.
    wrong = {
        file: rules ^ rules_of(file) for file, rules in marked.items() if rules != rules_of(file)
    }
    # Predictions that two figures share do not stand in the module of one of them.
    for name in DRAWN:
        assert marked[f"src/slippulse/figures/{name}.py"] == {name} | EVERY_SOURCE
    assert len(FILES) > 150
    assert wrong == {}
    # And no other file of the sources.
    others = {
        rule: inputs - set(FILES) for rule, inputs in seen.items() if not inputs <= set(FILES)
    }
    assert {"Snakefile", "workflow/rules/common.smk"} <= others.pop("write_provenance")
    # The report says what differs from the shipped configuration, and its version.
    assert others == {"write_report": {"CITATION.cff", "config/config.yaml"}}


def test_a_module_is_taken_by_name_only_where_the_rule_names_it():
    """An import that is computed at run time is not seen in the text of a module."""
    found = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if re.search(r"\bimport_module\(|__import__\(", path.read_text(encoding="utf-8"))
    }
    assert found == {
        "__init__.py", "steps/draw_figure.py", "steps/job.py", "steps/predict.py",
        "steps/run_study.py", "theory/__init__.py",
    }  # fmt: skip


def test_checksums_and_manifest_cover_what_everything_makes_and_what_is_ones_own(inputs):
    listed = {file for file in inputs["write_provenance"] if file.startswith("results/")}
    about_itself = {"results/provenance.json", "results/index.html"}
    assert inputs["everything"] == listed | about_itself
    for name in ("mine", "one", "barrier"):
        assert f"results/data/{name}.nc" in listed
        assert {
            f"results/{kind}/{name}.csv" for kind in ("measurements", "uncertainties")
        } <= listed
    assert {f"results/scenes/one.{ending}" for ending in ("html", "png", "pdf", "csv")} <= listed
    # Data of a figure and of a claim.
    assert {"results/data/steady_stress.nc", "results/measurements/scaling_stress.csv"} <= listed


@pytest.fixture(scope="module")
def downstream(imitated):
    """A function of some rules: these and all that takes what they make, directly or not."""
    drawn = snakemake(
        imitated, "--rulegraph", "mermaid-js", "--", *TARGETS, overlay="overlay.yaml"
    ).stdout

    def find(rules: Iterable[str]) -> set[str]:
        found = {*rules}
        while more := {fed for feeding, fed in edges(drawn) if feeding in found} - found:
            found |= more
        return found - NAMES

    return find


LOCK = "requirements.lock"
# One of each folder: that every file is a source of the rules that reach it is seen above.
EDITED = {Path(file).parent: file for file in FILES if Path(file).stem not in TOPICS}.values()


def jobs_after(folder: Path, change: str = "{}") -> dict[str, int]:
    """Jobs of a dry run with a line more in a file, or some values altered; not those that only name targets."""
    file, values = (change, "{}") if change in (*FILES, LOCK) else ("overlay.yaml", change)
    (folder / "values.yaml").write_text(values, encoding="utf-8")
    path = folder / file
    before, stat = path.read_bytes(), path.stat()
    try:
        path.write_bytes(before + b"\n# edited\n")
        overlays = ("overlay.yaml", "values.yaml")
        jobs = planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay=overlays))
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    return {rule: count for rule, count in jobs.items() if rule not in NAMES}


@pytest.mark.slow
@pytest.mark.parametrize("file", (*EDITED, LOCK))
def test_an_edit_runs_what_depends_on_the_file(imitated, downstream, file):
    assert set(jobs_after(imitated, file)) == downstream(RULES if file == LOCK else rules_of(file))


FIGURE = "fig07_damage_zone"
# What is removed, and the jobs that make it again: no others, since what they make is the same as before.
REMOVED = {
    "results/data/steady_stress.nc": "simulate",
    "results/measurements/scaling_stress.csv": "measure",
    "results/uncertainties/one.csv": "study_grid",
    "results/data/mine.nc": "join",
    "results/scenes/one.pdf": "draw_scene",
    f"results/figures/{FIGURE}.csv": FIGURE,
    "results/studies/extremes.csv": "study_of_extremes",
}


@pytest.mark.slow
def test_what_is_removed_is_made_again(imitated):
    kept = [(imitated / name).rename(imitated / f"{name}.kept") for name in REMOVED]
    try:
        jobs = jobs_after(imitated)
    finally:
        for path in kept:
            path.rename(path.with_suffix(""))
    assert set(REMOVED.values()) | {"write_provenance", "write_index"} <= set(jobs)
    # A chunk of another sweep is not simulated again.
    assert jobs["simulate"] == jobs["join"] == jobs[FIGURE] == 1


# The whole configuration stands in the report and in the provenance, what differs from the shipped one on the pages.
# And a study draws the claims.
ALWAYS, CHAIN, PUBLISHED = (dict.fromkeys(names.split(), 1) for names in (
    "write_claims study_open_choices write_report write_provenance write_index", "simulate measure predict study_grid",
    "fig04_space_time study_published_figure study_of_exact_space_time study_of_derivations",
))  # fmt: skip
# What is laid over the configuration, and what then runs besides.
CONFIGURATIONS = {
    "simulations: {space_time_displacement: {left: [0.3]}}": CHAIN | PUBLISHED,
    "simulations: {mine: {left: [0.5, 0.3]}}": dict.fromkeys(CHAIN, 2)
    | {"join": 4, "sweep_mine": 1},
    "simulations: {mine: {chunks: 1}}": CHAIN | {"sweep_mine": 1},
    f"figures: {{{FIGURE}: {{thickness_ratios: [0.3, 1.0]}}}}": {
        "study_of_damage_zone": 1,
        FIGURE: 1,
    },
    "scenes: {barrier: {title: Uno}}": {
        "draw_scene": 1,
        "animate_scene": 1,
        "write_scenes_page": 1,
    },
    "claims: {front_speed: {tolerance: 0.5}}": {},
    "allow_large: true": {},
}


@pytest.mark.slow
@pytest.mark.parametrize("change", CONFIGURATIONS)
def test_another_configuration_runs_only_its_chain(imitated, change):
    assert jobs_after(imitated, change) == CONFIGURATIONS[change] | ALWAYS


def studies_without(*read: str) -> set[str]:
    """Studies that read no tables, and neither some other kinds of files nor parts of the configuration."""
    read += ("data", "measured", "predicted", "uncertainties", "coarser", "studies")
    needs = {rule: declared(f"studies.{study}", "NEEDS") for rule, study in STUDIED.items()}
    keys = {
        rule: {*found, *found.get("settings", ())} - {"settings"} for rule, found in needs.items()
    }
    return {rule for rule, found in keys.items() if not any(key.startswith(read) for key in found)}


# Shared values and a topic of theory, with rules that read them and rules that must not run for them.
SKETCHES = {"fig01_system_sketch", FIGURE, "study_barriers", "compile_kernels"}
DATA = {"simulate", "animate_scene", "fig06_burridge_knopoff"}
UNMODELLED = studies_without("sweeps", "model")
HELD = {"fig08_steady_state_displacement", "fig10_damping_displacement"}
SHARED = {
    "measure: {share: 0.9}": (
        {"measure", "study_grid", "draw_scene", "write_claims", "fig05_scaling"},
        SKETCHES | DATA | HELD | studies_without("measure.share")),
    "model: {damping_ratio: 0.2}": (
        {"simulate", "measure", "study_grid", "animate_scene", "fig04_space_time"},
        # Its simulations have damping ratios of their own; figure 8 draws a study that reads those of figure 9 too.
        SKETCHES | UNMODELLED | {"fig10_damping_displacement"}),
    "measure: {front_window: 0.4}": (
        {"measure", "study_of_extremes", "fig03_steady_state"},
        SKETCHES | DATA | studies_without("measure.front_window")),
    "model: {release: elastic}": ({"simulate", "draw_scene"}, SKETCHES | UNMODELLED),
    "presets: {draft: {coarser: [2.0, 3.0]}}": ({"study_grid", "draw_scene"}, {"simulate", "measure"}),
    "src/slippulse/predict/pulse.py": (
        {"predict", "sweep_mine", "draw_scene", "fig08_steady_state_displacement"},
        {"fig02_phase_diagram", "fig05_scaling", "study_front_speed", "study_arrest"}),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("change", SHARED)
def test_what_is_shared_runs_what_reads_it_and_no_more(imitated, change):
    read_by, untouched = SHARED[change]
    jobs = set(jobs_after(imitated, change))
    assert read_by | set(ALWAYS) <= jobs and not untouched & jobs and untouched <= RULES


@pytest.mark.slow
def test_the_default_is_the_whole_paper_and_one_figure_needs_only_its_own_simulations(linked):
    jobs = planned(snakemake(linked, "--dry-run"))
    assert DRAWN | set(STUDIED) <= set(jobs)
    assert {"write_claims", "write_report", "write_provenance", "write_index", "draw_scene"} <= set(
        jobs
    )
    jobs = planned(snakemake(linked, "--dry-run", "--", "results/figures/fig04_space_time.png"))
    own = dict.fromkeys(("compile_kernels", "fig04_space_time", "study_of_exact_space_time"), 1)
    assert jobs == own | {"simulate": 2, "measure": 2}


def test_a_draft_is_the_figures_and_what_is_ones_own(linked):
    """Studies, the shipped scenes, the ledger and the report are made where everything is asked for."""
    result = snakemake(linked, "--dry-run", overlay="overlay.yaml")
    jobs = planned(result)
    assert (
        sum(name.startswith("fig") for name in jobs) == 11
        and jobs["draw_scene"] == jobs["study_grid"] == 1
    )
    drawn = {"damage_zone", "exact_space_time", "pulse_profiles", "regime_plane"}
    made = {name for name in jobs if name.startswith(("study_of", "write_"))}
    assert made == {f"study_of_{name}" for name in drawn}
    assert "Measuring mine/2-of-2" in result.stdout and "Drawing scene one" in result.stdout


@pytest.mark.slow
def test_the_graph_in_the_readme_is_the_pipelines(linked, project):
    targets = ("results/figures/fig05_scaling.png", "results/claims.json")
    drawn = snakemake(linked, "--rulegraph", "mermaid-js", "--", *targets)
    assert drawn.returncode == 0, drawn.stderr
    shown = (
        (project / "README.md").read_text(encoding="utf-8").split("```mermaid\n")[1].split("```")[0]
    )
    assert edges(shown) == edges(drawn.stdout) and ("simulate", "measure") in edges(shown)


@pytest.mark.slow
def test_a_run_shows_what_it_does_by_the_profile_and_snakemakes_report_is_one_file_that_loads_nothing(
    linked,
):
    """Without a terminal: one short line a job, and no pages of files and reasons."""
    result = snakemake(linked, "--force", "--", FIGURE, command=BY_PROFILE)
    said = result.stdout + result.stderr
    assert result.returncode == 0 and len(re.findall(rf"{FIGURE}: [0-9.]+ s", said)) == 1
    assert "input:" not in said and len(said.splitlines()) < 40
    result = snakemake(linked, "--report", "report.html", "--", f"results/figures/{FIGURE}.png")
    assert result.returncode == 0, result.stderr
    text = (linked / "report.html").read_text(encoding="utf-8")
    assert '"Figures of the paper"' in text and FIGURE in text
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?://", text)
