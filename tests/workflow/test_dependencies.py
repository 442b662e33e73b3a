"""Edits and altered values run the rules that depend on them, and no others.

The expected dependencies are found from imports, independently of the rules: every file of the
package and of the report's texts marks the rules whose step reaches it.
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


def modules_in(folder: str, pattern: str = "*.py") -> set[str]:
    return {path.stem for path in (PACKAGE / folder).glob(pattern)}


# Rules whose step takes a module by name: one a figure, one a study of the solver.
DRAWN = modules_in("figures", "fig*.py") | modules_in("figures", "study_*.py")
STUDIED = {
    f"study_of_{name}": name
    for name in modules_in("studies")
    if declared(f"studies.{name}", "NEEDS") is not None
}
# Modules that steps share, and steps whose rules are those of figures and studies.
NO_RULES = {"__init__", "inputs", "job", "libraries", "origins", "processes", "reach", "reading"}
NO_RULES |= {"targets"}
NO_RULES |= {"draw_figure", "run_study"}
STEPS = modules_in("steps") - NO_RULES
# Most simulations are solved by this scheme.
LATTICE = "solver.solution"
# Modules that a rule runs.
MODULES = {
    **{step: [f"steps.{step}"] for step in STEPS},
    **{name: ["steps.draw_figure", f"figures.{name}"] for name in DRAWN},
    **{rule: ["steps.run_study", f"studies.{study}"] for rule, study in STUDIED.items()},
    "sweep_mine": ["steps.draw_figure", "figures.user_defined_sweep"],
    "predict": ["steps.predict", *(f"predict.{topic}" for topic in TOPICS)],
    "simulate": ["steps.simulate", LATTICE],
    "study_grid": ["steps.study_grid", LATTICE],
}
RULES = {*MODULES}
# The templates that pages begin with, by the rules that write them.
PAGES_OF = {f"write_{name}": [f"{name}.html"] for name in ("claims", "explorer", "index")}
PAGES_OF |= {"write_report": ["report.html", "report.typ"]}
PAGES_OF |= {"draw_scene": ["scene.html"], "write_scenes_page": ["scenes.html"]}
# Texts beside the package, by the rules that read them; all others only the report reads.
READ_BY = {
    "captions.yaml": {"write_report", "write_index"},
    "summary.yaml": {"write_report", "write_index"},
    "errata.yaml": {"write_report", "write_index"},
    "claims.yaml": {"write_report", "write_claims"},
    "statements.yaml": {"write_report", "write_claims"},
    "open_choices.yaml": {"study_of_open_choices"},
}
# Rules that only name targets.
NAMES = {"all", *TARGETS}
# The rule that notes a digest of every source.
EVERY_SOURCE = {"write_provenance"}
# All files of the package and all texts.
PATHS = [path for path in [*PACKAGE.rglob("*"), *TEXTS.rglob("*")] if path.is_file()]
FILES = [path.relative_to(PROJECT).as_posix() for path in PATHS if "__pycache__" not in path.parts]
FILES.sort()


def module_file(name: str) -> str:
    path = f"src/{name.replace('.', '/')}"
    return f"{path}/__init__.py" if (PROJECT / path).is_dir() else f"{path}.py"


@cache
def imports() -> grimp.ImportGraph:
    """Graph of imports, in which a module imports the packages that it is in."""
    graph = grimp.build_graph("slippulse", cache_dir=None)
    modules = graph.modules - {"slippulse"}
    for name in modules:
        if "def __getattr__(" in (PROJECT / module_file(name)).read_text(encoding="utf-8"):
            import_all(graph, name)
    for name in modules:
        graph.add_import(importer=name, imported=name.rpartition(".")[0])
    return graph


def import_all(graph: grimp.ImportGraph, package: str) -> None:
    """Let the users of a package that loads its modules when they are asked for import them all."""
    for user in graph.find_modules_that_directly_import(package):
        for inside in graph.find_descendants(package):
            graph.add_import(importer=user, imported=inside)


@cache
def templates_of(page: str) -> set[str]:
    """A template and those that it is made with."""
    path = f"src/slippulse/report/templates/{page}"
    text = (PROJECT / path).read_text(encoding="utf-8")
    others = re.findall(r'{% (?:extends|include|import) "(.+?)"', text)
    return {path}.union(*map(templates_of, others))


@cache
def expected(rule: str) -> set[str]:
    """Files of the package and texts that a rule depends on."""
    modules = {f"slippulse.{name}" for name in MODULES[rule]}
    modules = modules.union(*map(imports().find_upstream_modules, modules))
    files = set(map(module_file, modules)).union(*map(templates_of, PAGES_OF.get(rule, ())))
    names = [path.name for path in TEXTS.iterdir()]
    texts = [name for name in names if rule in READ_BY.get(name, {"write_report"})]
    return files | {f"manuscript/{name}" for name in texts}


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
    files = {}
    entry = r'point-size="18">(\w+)</font>(.*?)(?=point-size="18"|\Z)'
    for name, text in re.findall(entry, result.stdout, re.S):
        taken = text.partition("&#8618; input")[2].partition("output &rarr;")[0]
        files[name] = set(map(html.unescape, re.findall(r'"monospace">([^<]+)<', taken)))
    return files


@pytest.fixture(scope="module")
def seen(inputs) -> dict[str, set[str]]:
    """Sources that each rule depends on: what its modules reach, and the texts that it takes."""
    depends = {}
    for name in inputs.keys() - NAMES:
        # The folder of the sources only has a time.
        files = inputs[name] - {"src"}
        texts = {file for file in files if not file.startswith(("results/", "<"))}
        depends[name] = texts.union(sources(*MODULES[name]))
    return depends


def test_every_file_marks_the_rules_whose_step_reaches_it(seen):
    # There is one rule a step, a figure and a study.
    assert set(seen) == RULES and len(FILES) > 150
    for file in FILES:
        assert {rule for rule, depends in seen.items() if file in depends} == rules_of(file), file
    # Predictions that two figures share do not stand in the module of one of them.
    for name in DRAWN:
        assert rules_of(f"src/slippulse/figures/{name}.py") == {name} | EVERY_SOURCE


def test_rules_depend_on_no_other_file_of_the_sources(seen):
    others = {rule: depends.difference(FILES) for rule, depends in seen.items()}
    assert {"Snakefile", "workflow/rules/common.smk"} <= others.pop("write_provenance")
    # The report says what differs from the shipped configuration, and its version.
    assert others.pop("write_report") == {"CITATION.cff", "config/config.yaml"}
    assert not any(others.values())


def test_a_module_is_taken_by_name_only_where_the_rule_names_it():
    """An import that is computed at run time is not seen in the text of a module."""
    computed = {
        path.relative_to(PACKAGE).with_suffix("").as_posix()
        for path in PACKAGE.rglob("*.py")
        if re.search(r"\b(import_module|__import__|resolve_name)\(", path.read_text("utf-8"))
    }
    named = ("draw_figure", "job", "predict", "run_study", "simulate", "study_grid")
    steps = {f"steps/{name}" for name in named}
    assert computed == steps | {"__init__", "theory/__init__"}


def test_checksums_and_manifest_cover_all_results_and_what_an_overlay_adds(inputs):
    listed = {file for file in inputs["write_provenance"] if file.startswith("results/")}
    about_itself = {"results/provenance.json", "results/index.html"}
    assert inputs["everything"] == listed | about_itself
    for name in ("mine", "one", "barrier"):
        made = (f"data/{name}.nc", f"measurements/{name}.csv", f"uncertainties/{name}.csv")
        assert {f"results/{file}" for file in made} <= listed
    assert {f"results/scenes/one.{ending}" for ending in ("html", "png", "pdf", "csv")} <= listed
    # Data of a figure and of a claim.
    assert {"results/data/steady_stress.nc", "results/measurements/scaling_stress.csv"} <= listed


@pytest.fixture(scope="module")
def downstream(imitated):
    """A function of some rules: these and all that take what they make, directly or not."""
    graph = ("--rulegraph", "mermaid-js", "--", *TARGETS)
    drawn = edges(snakemake(imitated, *graph, overlay="overlay.yaml").stdout)

    def find(rules: Iterable[str]) -> set[str]:
        reached, count = {*rules}, 0
        while len(reached) > count:
            count = len(reached)
            reached |= {taker for maker, taker in drawn if maker in reached}
        return reached - NAMES

    return find


LOCK = "requirements.lock"
# One file of each folder: a test above covers them all.
EDITED = {Path(file).parent: file for file in FILES if Path(file).stem not in TOPICS}.values()


def jobs_after(folder: Path, change: str = "{}") -> dict[str, int]:
    """Jobs of a dry run after an edit of a file or of some values, without those of names."""
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
# Files that are removed, and the only jobs that make them again.
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


# The whole configuration stands in the report and in the provenance, what an overlay alters on the
# pages; and a study draws the claims.
ALWAYS = ("write_claims", "study_open_choices", "write_report", "write_provenance", "write_index")
ALWAYS = dict.fromkeys(ALWAYS, 1)
CHAIN = ("simulate", "measure", "predict", "study_grid")
PUBLISHED = ("study_published_figure", "study_of_exact_space_time", "study_of_derivations")
SCENES = ("draw_scene", "animate_scene", "write_scenes_page")
# Values that are laid over the configuration, and which jobs then run besides.
CONFIGURATIONS = {
    "simulations: {space_time_displacement: {left: [0.3]}}": dict.fromkeys(
        (*CHAIN, *PUBLISHED, "fig04_space_time"), 1
    ),
    "simulations: {mine: {left: [0.5, 0.3]}}": dict.fromkeys(CHAIN, 2)
    | {"join": 4, "sweep_mine": 1},
    "simulations: {mine: {chunks: 1}}": dict.fromkeys((*CHAIN, "sweep_mine"), 1),
    f"figures: {{{FIGURE}: {{thickness_ratios: [0.3, 1.0]}}}}": dict.fromkeys(
        ("study_of_damage_zone", FIGURE), 1
    ),
    "scenes: {barrier: {title: Uno}}": dict.fromkeys(SCENES, 1),
    "claims: {front_speed: {tolerance: 0.5}}": {},
    "allow_large: true": {},
}


@pytest.mark.slow
@pytest.mark.parametrize("change", CONFIGURATIONS)
def test_another_configuration_runs_only_its_chain(imitated, change):
    assert jobs_after(imitated, change) == CONFIGURATIONS[change] | ALWAYS


def studies_without(*read: str) -> set[str]:
    """Studies that read no files, and not some sweeps or keys of the configuration."""
    read += ("data", "measured", "predicted", "uncertainties", "coarser", "studies")
    without = set()
    for rule, study in STUDIED.items():
        needs = declared(f"studies.{study}", "NEEDS")
        keys = {*needs, *needs.get("settings", ())} - {"settings"}
        if not any(key.startswith(read) for key in keys):
            without.add(rule)
    return without


SKETCHES = {"fig01_system_sketch", FIGURE, "study_barriers", "compile_kernels"}
DATA = {"simulate", "animate_scene", "fig06_burridge_knopoff"}
HELD = {"fig08_steady_state_displacement", "fig10_damping_displacement"}
UNMODELLED = SKETCHES | studies_without("sweeps", "model")
GRIDS = {"measure", "study_grid"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "readers", "untouched"),
    [
        (
            "measure: {share: 0.9}",
            GRIDS | {"draw_scene", "write_claims", "fig05_scaling"},
            SKETCHES | DATA | HELD | studies_without("measure.share"),
        ),
        (
            "model: {damping_ratio: 0.2}",
            GRIDS | {"simulate", "animate_scene", "fig04_space_time"},
            # Its simulations have damping ratios of their own.
            UNMODELLED | {"fig10_damping_displacement"},
        ),
        (
            "measure: {front_window: 0.4}",
            {"measure", "study_of_extremes", "fig03_steady_state"},
            SKETCHES | DATA | studies_without("measure.front_window"),
        ),
        ("model: {release: elastic}", {"simulate", "draw_scene"}, UNMODELLED),
        (
            "presets: {draft: {coarser: [2.0, 3.0]}}",
            {"study_grid", "draw_scene"},
            {"simulate", "measure"},
        ),
        (
            "src/slippulse/predict/pulse.py",
            {"predict", "sweep_mine", "draw_scene", "fig08_steady_state_displacement"},
            {"fig02_phase_diagram", "fig05_scaling", "study_front_speed", "study_arrest"},
        ),
    ],
    ids=["share", "damping ratio", "front window", "release", "coarser lattices", "prediction"],
)
def test_a_shared_value_or_topic_runs_its_readers_alone(imitated, change, readers, untouched):
    jobs = set(jobs_after(imitated, change))
    assert readers | set(ALWAYS) <= jobs and not untouched & jobs and untouched <= RULES


@pytest.mark.slow
def test_the_default_is_the_whole_paper_and_one_figure_needs_only_its_own_simulations(linked):
    jobs = planned(snakemake(linked, "--dry-run"))
    pages = {"write_claims", "write_report", "write_provenance", "write_index", "draw_scene"}
    assert pages | DRAWN | set(STUDIED) <= set(jobs)
    jobs = planned(snakemake(linked, "--dry-run", "--", "results/figures/fig04_space_time.png"))
    once = dict.fromkeys(("compile_kernels", "fig04_space_time", "study_of_exact_space_time"), 1)
    assert jobs == once | {"simulate": 2, "measure": 2}


def test_a_draft_is_the_figures_and_what_an_overlay_adds(linked):
    """Only `everything` makes all studies, the shipped scenes, the claims and the report."""
    result = snakemake(linked, "--dry-run", overlay="overlay.yaml")
    jobs = planned(result)
    assert len([name for name in jobs if name.startswith("fig")]) == 11
    assert jobs["draw_scene"] == jobs["study_grid"] == 1
    drawn = {"damage_zone", "exact_space_time", "pulse_profiles", "regime_plane"}
    made = {name for name in jobs if name.startswith(("study_of", "write_"))}
    assert made == {f"study_of_{name}" for name in drawn}
    assert "Measuring mine/2-of-2" in result.stdout and "Drawing scene one" in result.stdout


@pytest.mark.slow
def test_the_graph_in_the_readme_is_the_pipelines(linked, project):
    targets = ("results/figures/fig05_scaling.png", "results/claims.json")
    drawn = snakemake(linked, "--rulegraph", "mermaid-js", "--", *targets)
    assert drawn.returncode == 0, drawn.stderr
    readme = (project / "README.md").read_text(encoding="utf-8")
    shown = readme.split("```mermaid\n")[1].split("```")[0]
    assert edges(shown) == edges(drawn.stdout) and ("simulate", "measure") in edges(shown)


@pytest.mark.slow
def test_without_a_terminal_a_run_shows_one_short_line_a_job(linked):
    result = snakemake(linked, "--force", "--", FIGURE, command=BY_PROFILE)
    said = result.stdout + result.stderr
    assert result.returncode == 0 and len(re.findall(rf"{FIGURE}: [0-9.]+ s", said)) == 1
    assert "input:" not in said and len(said.splitlines()) < 40


@pytest.mark.slow
def test_the_report_of_snakemake_is_one_file_that_loads_nothing(linked):
    assert snakemake(linked, "--", FIGURE).returncode == 0
    result = snakemake(linked, "--report", "report.html", "--", f"results/figures/{FIGURE}.png")
    assert result.returncode == 0, result.stderr
    text = (linked / "report.html").read_text(encoding="utf-8")
    assert '"Figures of the paper"' in text and FIGURE in text
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?://", text)
