"""Build the documentation as a site from the files of the repository: `make docs`.

python docs/build_site.py FOLDER

Pages keep the place that they have in the repository, so that their links hold. A link to a file
that is not a page becomes its text.
"""

import os
import re
import shutil
import sys
from pathlib import Path
from types import ModuleType

import jupytext

import slippulse
from slippulse import theory

PROJECT = Path(__file__).resolve().parents[1]
PAGES = ("CONTRIBUTING.md", "CHANGELOG.md", "config/README.md")
NOTEBOOKS = ("docs/tutorial.md",)
# The first page of the site; links to the README lead to it.
INDEX = "docs/index.md"
# Pages whose place in the site is another one than in the repository.
PLACES = {INDEX: "index.md"} | {name: name.replace(".md", ".ipynb") for name in NOTEBOOKS}
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?!https?:|#)([^)#\s]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)


def collect(sources: Path) -> None:
    """Copy all pages into a folder, with the tutorial as a notebook and one page per object."""
    pages = [*PAGES, *files_of_docs("**/*.md")]
    scripts = files_of_docs("gallery/*.py")
    names = {*pages, *scripts}
    for name in pages:
        text = with_site_links((PROJECT / name).read_text(encoding="utf-8"), name, names)
        if name in NOTEBOOKS:
            text = jupytext.writes(jupytext.reads(text, fmt="md"), fmt="ipynb")
        write(sources / PLACES.get(name, name), text)
    for name in [*scripts, *files_of_docs("**/*.png"), *files_of_docs("**/*.svg")]:
        copy(PROJECT / name, sources / name)
    for package in (slippulse, theory):
        write(sources / f"reference/{package.__name__}.md", reference_page(package))


def files_of_docs(pattern: str) -> list[str]:
    """Return the paths below the project of the files in docs that match a pattern."""
    paths = (PROJECT / "docs").glob(pattern)
    return [path.relative_to(PROJECT).as_posix() for path in paths]


def with_site_links(text: str, page: str, names: set[str]) -> str:
    """Return a page in which links to other pages lead to their place in the site.

    Other links to files become their text. Code is not changed.
    """

    def replaced(link: re.Match) -> str:
        text, target, anchor = link.groups(default="")
        path = (PROJECT / page).parent.joinpath(target).resolve()
        name = path.relative_to(PROJECT).as_posix() if path.is_relative_to(PROJECT) else ""
        if name == "README.md":
            name = INDEX
        if name not in names:
            return text
        return f"[{text}](/{PLACES.get(name, name)}{anchor})"

    # Texts and blocks of code alternate.
    parts = FENCE.split(text)
    for position in range(0, len(parts), 2):
        parts[position] = LINK.sub(replaced, parts[position])
    return "".join(parts)


def reference_page(package: ModuleType) -> str:
    """Return the page that lists the public names of a package, with a page for each."""
    title, summary = package.__name__, (package.__doc__ or "").strip()
    names = sorted({*package.__all__} - {"theory", "__version__"})
    lines = [f"# {title}", "", summary, "", "```{eval-rst}", f".. currentmodule:: {title}", ""]
    lines += [".. autosummary::", f"   :toctree: {title}", "   :nosignatures:", ""]
    lines += [f"   {name}" for name in names]
    return "\n".join([*lines, "```", ""])


def write(path: Path, text: str) -> None:
    """Write a source if it has changed, so that Sphinx reads only what is new."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def copy(source: Path, path: Path) -> None:
    """Copy a source with its time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, path)


def main(folder: str) -> int:
    """Collect the sources below .site and build the site in a folder; warnings are errors."""
    from sphinx.cmd.build import main as build

    sources = PROJECT / ".site/sources"
    collect(sources)
    # The kernel of the notebooks reads no settings of the user, and reports errors alone.
    settings = "profile_default/ipython_kernel_config.py"
    write(PROJECT / ".site/ipython" / settings, "c.IPKernelApp.log_level = 40\n")
    os.environ["IPYTHONDIR"] = str(PROJECT / ".site/ipython")
    # Executed notebooks are written beside the pages, and do not belong into the results. Each page
    # lists the others, so that all are written.
    pages = PROJECT / ".site/pages"
    shutil.rmtree(pages, ignore_errors=True)
    options = ["-q", "-a", "-W", "--keep-going", "-j", "2", "-d", str(PROJECT / ".site/doctrees")]
    code = build([*options, "-c", str(PROJECT / "docs/site"), str(sources), str(pages)])
    if code == 0:
        if Path(folder, ".buildinfo").exists():
            shutil.rmtree(folder)
        shutil.copytree(pages, folder, dirs_exist_ok=True)
        print(f"Open {folder}/index.html")
    return code


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python docs/build_site.py FOLDER")
    sys.exit(main(sys.argv[1]))
