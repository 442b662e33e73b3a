"""Which rules of the workflow depend on which files of the sources, found from the imports and not from the rules."""

import re
from functools import cache
from pathlib import Path

import grimp
from jinja2 import meta

from slippulse.report.html import PAGES
from slippulse.steps.predict import TOPICS

PROJECT = Path(__file__).resolve().parents[1]
PACKAGE = PROJECT / "src/slippulse"
TEXTS = PROJECT / "manuscript"
# A user-defined sweep, in chunks so that there are the rules that join them, and a scene.
OVERLAY = {
    "simulations": {
        "own": {
            "boundary": "displacement", "left": [0.3, 0.5], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
            "spacing": {"scale": 4.0}, "record": ["fronts"], "chunks": 2,
        }
    },
    "scenes": {
        "mine": {
            "title": "Mine", "boundary": "displacement", "left": 0.5, "right": 0.6, "gamma": 0.65, "dx": 0.1,
            "duration": 6.0,
        }
    },
}  # fmt: skip
# Rules whose step takes a module by name: one a figure, one a study of the solver.
DRAWN = {path.stem for pattern in ("fig*.py", "study_*.py") for path in (PACKAGE / "figures").glob(pattern)}
STUDIED = {
    f"study_of_{path.stem}": path.stem
    for path in (PACKAGE / "studies").glob("*.py")
    if re.search(r"^NEEDS = ", path.read_text(encoding="utf-8"), re.M)
}
STEPS = {path.stem for path in (PACKAGE / "steps").glob("*.py")}
# Every rule but those that only name targets; two schemes take other steps of the same rules.
NO_RULES = {"__init__", "inputs", "job", "libraries", "reach", "targets"}
NO_RULES |= {"draw_figure", "run_study"} | {
    step for step in STEPS if step.endswith(("_continuum", "_fixed_step"))
}
SWEEP = "sweep_own"
RULES = (STEPS - NO_RULES) | DRAWN | set(STUDIED) | {SWEEP}
# Pages, by the rule that writes them: the template that each begins with.
PAGE_OF = {
    "draw_scene": "scene.html",
    "write_claims": "claims.html",
    "write_explorer": "explorer.html",
    "write_index": "index.html",
    "write_report": "report.html",
    "write_scenes_page": "scenes.html",
}
# Texts beside the package, by the rules that read them.
READ_BY = {
    "captions.yaml": {"write_report", "write_index"},
    "claims.yaml": {"write_claims", "write_report"},
    "errata.yaml": {"write_report"},
    "metadata.yaml": {"write_report"},
    "open_choices.yaml": {"study_of_open_choices"},
    "references.bib": {"write_report"},
    "replication.md": {"write_report"},
    "shipped_verdicts.yaml": {"write_report"},
    "statements.yaml": {"write_claims", "write_report"},
    "summary.yaml": {"write_index", "write_report"},
    "supplement.md": {"write_report"},
}
# Notes a digest of every source.
EVERY_SOURCE = {"write_provenance"}
FILES = sorted(
    path.relative_to(PROJECT).as_posix()
    for folder in (PACKAGE, TEXTS)
    for path in folder.rglob("*")
    if path.is_file() and "__pycache__" not in path.parts
)


@cache
def imports() -> grimp.ImportGraph:
    return grimp.build_graph("slippulse", cache_dir=None)


def module_file(name: str) -> str:
    path = PROJECT / "src" / Path(*name.split("."))
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return path.relative_to(PROJECT).as_posix()


def is_lazy(name: str) -> bool:
    """Whether a package loads what it offers when that is used."""
    return "def __getattr__(" in (PROJECT / module_file(name)).read_text(encoding="utf-8")


@cache
def reached_by(*modules: str) -> set[str]:
    """Files of all modules that some modules import, one through the other, the packages that they are in included."""
    graph, reached = imports(), set()
    pending = [f"slippulse.{name}" for name in modules]
    while pending:
        name = pending.pop()
        if name in reached:
            continue
        reached.add(name)
        if "." in name:
            pending.append(name.rpartition(".")[0])
        for imported in graph.find_modules_directly_imported_by(name):
            pending.append(imported)
            # What is taken from a package that loads as it goes may be in any of its modules.
            if imported != "slippulse" and is_lazy(imported):
                pending += graph.find_descendants(imported)
    return {module_file(name) for name in reached}


@cache
def templates_of(page: str) -> set[str]:
    """Templates that a page is made with."""
    source, _, _ = PAGES.loader.get_source(PAGES, page)
    found = {(PACKAGE / "report/templates" / page).relative_to(PROJECT).as_posix()}
    for other in meta.find_referenced_templates(PAGES.parse(source)):
        found |= templates_of(other)
    return found


def modules_of_rule(rule: str) -> tuple[str, ...]:
    """Modules that a rule runs."""
    if rule in DRAWN:
        return ("steps.draw_figure", f"figures.{rule}")
    if rule == SWEEP:
        return ("steps.draw_figure", "figures.own_sweep")
    if rule in STUDIED:
        return ("steps.run_study", f"studies.{STUDIED[rule]}")
    if rule == "predict":
        return ("steps.predict", *(f"predict.{topic}" for topic in TOPICS))
    return (f"steps.{rule}",)


@cache
def expected(rule: str) -> set[str]:
    """Files of the package and texts that a rule depends on."""
    found = reached_by(*modules_of_rule(rule))
    found |= templates_of(PAGE_OF[rule]) if rule in PAGE_OF else set()
    found |= {"src/slippulse/report/templates/report.typ"} if rule == "write_report" else set()
    found |= {f"manuscript/{name}" for name, rules in READ_BY.items() if rule in rules}
    return found


@cache
def rules_of(file: str) -> set[str]:
    """Rules that an edit of a file of the sources marks."""
    return {rule for rule in RULES if file in expected(rule)} | EVERY_SOURCE
