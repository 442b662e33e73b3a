"""Find the rules that run again after an edit of a source file.

A rule runs again if its step imports the file, directly or indirectly, or reads it. This is worked
out here independently of the workflow, as a reference for its tests.
"""

import re
from functools import cache
from itertools import combinations as subsets
from pathlib import Path

import grimp

from slippulse_paper.steps.needs import needs_of
from slippulse_paper.steps.predict import MODULES as TOPIC_MODULES
from slippulse_paper.steps.simulate import SOLVERS

PROJECT = Path(__file__).resolve().parents[1]
PACKAGE, TEXTS = PROJECT / "src/slippulse_paper", PROJECT / "manuscript"
LIBRARY = PROJECT / "src/slippulse"


def modules_in(folder: str, pattern: str) -> set[str]:
    """Return the names of the modules in a folder that match a pattern."""
    return {path.stem for path in (PACKAGE / folder).glob(pattern)}


# Jobs whose step takes a module by name: one for each figure, and one for each study.
DRAWN = modules_in("figures", "fig*.py") | modules_in("figures", "study_*.py")
STUDIED = {f"study_of_{name}": name for name in needs_of("studies")}
# Modules that steps share, and steps whose jobs are those of figures and studies.
SHARED = {"__init__", "inputs", "job", "needs", "worker_libraries", "worker_pool", "joined_files"}
SHARED |= {"draw_figure", "run_study"}
# Modules that a job runs, by the name of the rule, figure or study.
MODULES = {step: [f"steps.{step}"] for step in modules_in("steps", "*.py") - SHARED}
MODULES |= {name: ["steps.draw_figure", f"figures.{name}"] for name in DRAWN}
MODULES |= {rule: ["steps.run_study", f"studies.{study}"] for rule, study in STUDIED.items()}
MODULES["sweep_mine"] = ["steps.draw_figure", "figures.user_defined_sweep"]
PREDICTION_MODULES = [f"slippulse.prediction.{name}" for name in TOPIC_MODULES.values()]
SOLVER_MODULES = [solver.partition(":")[0] for solver in SOLVERS.values()]
MODULES["predict"] += PREDICTION_MODULES
# Most simulations are solved by this scheme.
for rule in ("simulate", "study_grid"):
    MODULES[rule].append("slippulse.solver.solution")
# Modules of which a job runs only some, by its settings.
OPTIONAL_MODULES = {
    "predict": PREDICTION_MODULES,
    "simulate": SOLVER_MODULES,
    "study_grid": SOLVER_MODULES,
}
RULES = {*MODULES}
# The templates that each rule fills. They may include others.
TEMPLATES = {
    "draw_scene": ["scene.html"],
    "write_claims": ["claims.html"],
    "write_explorer": ["explorer.html"],
    "write_index": ["index.html"],
    "write_report": ["report.html", "report.typ", "report.csl"],
    "write_scenes_page": ["scenes.html"],
}
# The rules that read each text in manuscript/. Only the report reads the others.
READERS = {
    "claims.yaml": {"write_report", "write_claims"},
    "statements.yaml": {"write_report", "write_claims"},
    "open_choices.yaml": {"study_of_open_choices"},
}
# The rule that records a digest of every source.
EVERY_SOURCE = {"write_index"}


def files_below(folder: Path) -> list[str]:
    """Return the paths below the project of all files in a folder, without compiled modules."""
    paths = [path for path in folder.rglob("*") if path.is_file()]
    sources = [path for path in paths if "__pycache__" not in path.parts]
    return [path.relative_to(PROJECT).as_posix() for path in sources]


# All files of both packages and all texts.
FILES = sorted([*files_below(PACKAGE), *files_below(LIBRARY), *files_below(TEXTS)])


def module_file(name: str) -> str:
    """Return the path of a module below the project."""
    path = f"src/{name.replace('.', '/')}"
    return f"{path}/__init__.py" if (PROJECT / path).is_dir() else f"{path}.py"


def full_name(module: str) -> str:
    """Return the name of a module with its package, which is slippulse_paper by default."""
    return module if module.startswith("slippulse.") else f"slippulse_paper.{module}"


@cache
def imports() -> grimp.ImportGraph:
    """Return the graph of imports, in which a module also imports the packages that it is in."""
    graph = grimp.build_graph(
        "slippulse", "slippulse_paper", cache_dir=None, exclude_type_checking_imports=True
    )
    modules = graph.modules - {"slippulse", "slippulse_paper"}
    for name in modules:
        graph.add_import(importer=name, imported=name.rpartition(".")[0])
    return graph


@cache
def template_files(name: str) -> set[str]:
    """Return the paths of a template and of all templates that it includes."""
    path = f"src/slippulse_paper/report/templates/{name}"
    text = (PROJECT / path).read_text(encoding="utf-8")
    included = re.findall(r'{% (?:extends|include|import) "(.+?)"', text)
    return {path}.union(*map(template_files, included))


def combinations(rule: str) -> list[list[str]]:
    """List the combinations of modules that the jobs of a rule may run."""
    optional = OPTIONAL_MODULES.get(rule, [])
    fixed = [name for name in MODULES[rule] if name not in optional]
    result = []
    for count in range(len(optional) + 1):
        for chosen in subsets(optional, count):
            result.append([*fixed, *chosen])
    return result


@cache
def expected_files(rule: str) -> set[str]:
    """Return the files that a rule depends on."""
    return files_of(rule, MODULES[rule])


def files_of(rule: str, module_names: list[str]) -> set[str]:
    """Return the files that a job of a rule depends on, by the modules that it runs."""
    modules = {full_name(name) for name in module_names}
    imported = [imports().find_upstream_modules(module) for module in modules]
    files = {module_file(module) for module in modules.union(*imported)}
    for template in TEMPLATES.get(rule, ()):
        files |= template_files(template)
    for path in TEXTS.iterdir():
        if rule in READERS.get(path.name, {"write_report"}):
            files.add(f"manuscript/{path.name}")
    return files


@cache
def rules_of(file: str) -> set[str]:
    """Return the rules that run again after an edit of a source file."""
    return {rule for rule in RULES if file in expected_files(rule)} | EVERY_SOURCE
