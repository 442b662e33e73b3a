"""Rules that an edit of a source marks, by the imports of the modules that they run.

They are found independently of the rules: every file of the package and of the report's texts marks
the rules whose step reaches it.
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


def modules_in(folder: str, *patterns: str) -> set[str]:
    return {path.stem for pattern in patterns for path in (PACKAGE / folder).glob(pattern)}


# Jobs whose step takes a module by name: one for each figure, and one for each study.
DRAWN = modules_in("figures", "fig*.py", "study_*.py")
STUDIED = {f"study_of_{name}": name for name in needs_of("studies")}
# Modules that steps share, and steps whose jobs are those of figures and studies.
SHARED = {"__init__", "inputs", "job", "needs", "worker_libraries", "worker_pool", "joined_files"}
SHARED |= {"draw_figure", "run_study"}
# Modules that a job runs: by rule, and by name for figures and studies.
MODULES = {step: [f"steps.{step}"] for step in modules_in("steps", "*.py") - SHARED}
MODULES |= {name: ["steps.draw_figure", f"figures.{name}"] for name in DRAWN}
MODULES |= {rule: ["steps.run_study", f"studies.{study}"] for rule, study in STUDIED.items()}
MODULES["sweep_mine"] = ["steps.draw_figure", "figures.user_defined_sweep"]
MODULES["predict"] += [f"slippulse.prediction.{name}" for name in TOPIC_MODULES.values()]
# Most simulations are solved by this scheme.
for solving in ("simulate", "study_grid"):
    MODULES[solving].append("slippulse.solver.solution")
# Modules of which a job runs only some, by its settings.
SOME_OF = {"predict": [f"slippulse.prediction.{name}" for name in TOPIC_MODULES.values()]}
SOME_OF["simulate"] = [solver.partition(":")[0] for solver in SOLVERS.values()]
SOME_OF["study_grid"] = SOME_OF["simulate"]
RULES = {*MODULES}
# The templates that pages begin with, by the rules that write them.
PAGES_OF = {f"write_{name}": [f"{name}.html"] for name in ("claims", "explorer", "index")}
PAGES_OF |= {"write_report": ["report.html", "report.typ", "report.csl"]}
PAGES_OF |= {"draw_scene": ["scene.html"], "write_scenes_page": ["scenes.html"]}
# Texts beside the package, by the rules that read them; all others only the report reads.
ON_CLAIMS = {"write_report", "write_claims"}
READ_BY = {"claims.yaml": ON_CLAIMS, "statements.yaml": ON_CLAIMS}
READ_BY["open_choices.yaml"] = {"study_of_open_choices"}
# The rule that notes a digest of every source.
EVERY_SOURCE = {"write_index"}
# All files of the package and all texts.
PATHS = [
    path for path in [*PACKAGE.rglob("*"), *LIBRARY.rglob("*"), *TEXTS.rglob("*")] if path.is_file()
]
FILES = [path.relative_to(PROJECT).as_posix() for path in PATHS if "__pycache__" not in path.parts]
FILES.sort()


def module_file(name: str) -> str:
    path = f"src/{name.replace('.', '/')}"
    return f"{path}/__init__.py" if (PROJECT / path).is_dir() else f"{path}.py"


def full_name(module: str) -> str:
    return module if module.startswith("slippulse.") else f"slippulse_paper.{module}"


@cache
def imports() -> grimp.ImportGraph:
    """Graph of imports, in which a module imports the packages that it is in."""
    graph = grimp.build_graph(
        "slippulse", "slippulse_paper", cache_dir=None, exclude_type_checking_imports=True
    )
    modules = graph.modules - {"slippulse", "slippulse_paper"}
    for name in modules:
        graph.add_import(importer=name, imported=name.rpartition(".")[0])
    return graph


@cache
def templates_of(page: str) -> set[str]:
    """A template and those that it is made with."""
    path = f"src/slippulse_paper/report/templates/{page}"
    text = (PROJECT / path).read_text(encoding="utf-8")
    others = re.findall(r'{% (?:extends|include|import) "(.+?)"', text)
    return {path}.union(*map(templates_of, others))


def combinations(rule: str) -> list[list[str]]:
    """List the combinations of modules that the jobs of a rule may run."""
    fixed = [name for name in MODULES[rule] if name not in SOME_OF.get(rule, ())]
    choices = SOME_OF.get(rule, [])
    counts = range(len(choices) + 1)
    return [[*fixed, *chosen] for count in counts for chosen in subsets(choices, count)]


@cache
def expected(rule: str) -> set[str]:
    """Files of the package and texts that a rule depends on."""
    return files_of(rule, MODULES[rule])


def files_of(rule: str, names: list[str]) -> set[str]:
    """Files of the package and texts that a job depends on, by the modules that it runs."""
    modules = {full_name(name) for name in names}
    modules = modules.union(*map(imports().find_upstream_modules, modules))
    files = set(map(module_file, modules)).union(*map(templates_of, PAGES_OF.get(rule, ())))
    names = [path.name for path in TEXTS.iterdir()]
    texts = [name for name in names if rule in READ_BY.get(name, {"write_report"})]
    return files | {f"manuscript/{name}" for name in texts}


@cache
def rules_of(file: str) -> set[str]:
    """Rules that an edit of a file of the sources marks."""
    return {rule for rule in RULES if file in expected(rule)} | EVERY_SOURCE
