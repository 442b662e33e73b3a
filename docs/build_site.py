"""Build the documentation as a site from what is in the repository: `make docs`.

python docs/build_site.py FOLDER

Pages keep the place that they have in the repository, so that their links hold. A link to a file
that is no page becomes its text.
"""

import os
import re
import shutil
import sys
from pathlib import Path

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
    docs = [path.relative_to(PROJECT) for path in (PROJECT / "docs").rglob("*")]
    pages = [*map(Path, PAGES), *(path for path in docs if path.suffix == ".md")]
    notebooks = [path for path in docs if path.parent.name == "gallery" and path.suffix == ".py"]
    names = {path.as_posix() for path in [*pages, *notebooks]}
    for path in pages:
        text = linked((PROJECT / path).read_text(encoding="utf-8"), path, names)
        if path.as_posix() in NOTEBOOKS:
            text = jupytext.writes(jupytext.reads(text, fmt="md"), fmt="ipynb")
        write(sources / PLACES.get(path.as_posix(), path.as_posix()), text)
    for path in [*notebooks, *(path for path in docs if path.suffix in (".png", ".svg"))]:
        copy(PROJECT / path, sources / path)
    for package in (slippulse, theory):
        write(sources / f"reference/{package.__name__}.md", reference_page(package))


def linked(text: str, page: Path, names: set[str]) -> str:
    """Return a page in which only links to other pages are left; code stays as it is."""

    def replaced(link: re.Match) -> str:
        target = (PROJECT / page.parent / link[2]).resolve()
        inside = target.is_relative_to(PROJECT) and target.relative_to(PROJECT).as_posix()
        inside = INDEX if inside == "README.md" else inside
        if inside not in names:
            return link[1]
        place = PLACES.get(inside, inside)
        return f"[{link[1]}](/{place}{link[3] or ''})"

    parts = FENCE.split(text)
    return "".join(LINK.sub(replaced, part) if i % 2 == 0 else part for i, part in enumerate(parts))


def reference_page(package: object) -> str:
    """Return the page that lists the public names of a package, with a page for each."""
    names = "\n".join(sorted(set(package.__all__) - {"theory", "__version__"}))
    title = package.__name__
    summary = (package.__doc__ or "").strip()
    return (
        f"# {title}\n\n{summary}\n\n```{{eval-rst}}\n.. currentmodule:: {title}\n\n"
        f".. autosummary::\n   :toctree: {title}\n   :nosignatures:\n\n"
        + "".join(f"   {name}\n" for name in names.splitlines())
        + "```\n"
    )


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
