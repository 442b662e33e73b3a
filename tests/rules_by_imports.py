"""Rules that an edit of a source marks, by the imports of the modules that they run.

They are found independently of the rules: every file of the package and of the report's texts marks
the rules whose step reaches it.
"""

import re
from functools import cache
from pathlib import Path

import grimp
from slippulse_paper.steps.reach import needs_of

from slippulse_paper.steps.predict import MODULES as TOPIC_MODULES

PROJECT = Path(__file__).resolve().parents[1]
PACKAGE, TEXTS = PROJECT / "src/slippulse_paper", PROJECT / "manuscript"
LIBRARY = PROJECT / "src/slippulse"


def modules_in(folder: str, *patterns: str) -> set[str]:
    return {path.stem for pattern in patterns for path in (PACKAGE / folder).glob(pattern)}


# Rules whose step takes a module by name: one a figure, one a study of the solver.
DRAWN = modules_in("figures", "fig*.py", "study_*.py")
STUDIED = {f"study_of_{name}": name for name in needs_of("studies")}
# Modules that steps share, and steps whose rules are those of figures and studies.
SHARED = {"__init__", "inputs", "job", "libraries", "origins", "processes", "reach", "reading"}
SHARED |= {"targets", "draw_figure", "run_study", "joined_files"}
# Modules that a rule runs.
MODULES = {step: [f"steps.{step}"] for step in modules_in("steps", "*.py") - SHARED}
MODULES |= {name: ["steps.draw_figure", f"figures.{name}"] for name in DRAWN}
MODULES |= {rule: ["steps.run_study", f"studies.{study}"] for rule, study in STUDIED.items()}
MODULES["sweep_mine"] = ["steps.draw_figure", "figures.user_defined_sweep"]
MODULES["predict"] += [f"slippulse.prediction.{name}" for name in TOPIC_MODULES.values()]
# Most simulations are solved by this scheme.
for solving in ("simulate", "study_grid"):
    MODULES[solving].append("slippulse.solver.solution")
RULES = {*MODULES}
# The templates that pages begin with, by the rules that write them.
PAGES_OF = {f"write_{name}": [f"{name}.html"] for name in ("claims", "explorer", "index")}
PAGES_OF |= {"write_report": ["report.html", "report.typ"]}
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
    graph = grimp.build_graph("slippulse", "slippulse_paper", cache_dir=None)
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


@cache
def expected(rule: str) -> set[str]:
    """Files of the package and texts that a rule depends on."""
    modules = {full_name(name) for name in MODULES[rule]}
    modules = modules.union(*map(imports().find_upstream_modules, modules))
    files = set(map(module_file, modules)).union(*map(templates_of, PAGES_OF.get(rule, ())))
    names = [path.name for path in TEXTS.iterdir()]
    texts = [name for name in names if rule in READ_BY.get(name, {"write_report"})]
    return files | {f"manuscript/{name}" for name in texts}


@cache
def rules_of(file: str) -> set[str]:
    """Rules that an edit of a file of the sources marks."""
    return {rule for rule in RULES if file in expected(rule)} | EVERY_SOURCE
