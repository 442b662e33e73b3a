"""Write the replication report and its supplement, each as HTML and PDF."""

import json
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import yaml

from slippulse.data.files import write_text

from ..claims.claim_texts import read_text
from ..report.document import write_html, write_pdf
from ..report.manuscript import DOCUMENTS, Inputs, execute, names_for
from .inputs import load_inputs

# Folders of results whose name is not the kind of their tables.
FOLDERS = {"measured": "measurements", "predicted": "predictions"}
NEEDS = {
    "measured": {
        "scaling_displacement": ["transition"],
        "space_time_displacement": ["front"],
        "space_time_stress": ["transition"],
    },
    "uncertainties": ["scaling_displacement", "scaling_stress", "steady_displacement"],
    "studies": ["arrest_path", "derivations", "extremes", "layer", "stability"],
}
VERDICTS_COMMENT = (
    "# Verdict of each claim. manuscript/shipped_verdicts.yaml has those of the shipped"
    " configuration."
)


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write ``html`` and ``pdf`` of the report and its supplement, and the file ``verdicts``.

    The files are those that `inputs_of` reads. The settings have the names of the figures, and the
    configuration (``config``).
    """
    inputs = inputs_of(files, settings)
    folder = inputs.manuscript
    # Each document is written by a separate process, and so threads are enough to write them at the
    # same time.
    with ThreadPoolExecutor() as pool:
        pending = []
        for document, html, pdf in zip(DOCUMENTS, outputs["html"], outputs["pdf"], strict=True):
            text = execute(folder / f"{document}.md", inputs)
            pending.append(pool.submit(write_html, text, folder, html))
            pending.append(pool.submit(write_pdf, text, folder, pdf))
    for future in pending:
        # This raises an exception if the document could not be written.
        future.result()
    verdicts = {claim["id"]: claim["verdict"] for claim in inputs.claims}
    table = yaml.safe_dump(verdicts, sort_keys=False)
    write_text(f"{VERDICTS_COMMENT}\n{table}", outputs["verdicts"])


def inputs_of(files: Mapping, settings: Mapping) -> Inputs:
    """Read everything that the report is written from, given the files and settings of its rule."""
    return Inputs(
        config=settings["config"],
        shipped=read_text(files["shipped"]),
        claims=json.loads(Path(files["claims"]).read_text(encoding="utf-8")),
        findings=json.loads(Path(files["findings"]).read_text(encoding="utf-8")),
        tables=load_inputs(files).tables,
        figures=settings["figures"],
        figures_folder=Path(files["figures"][0]).resolve().parent,
        manuscript=Path(files["sources"][0]).resolve().parent,
        citation=read_text(files["citation"]),
    )


def notebook_names(document: str, show: Callable[[str], None] | None = None) -> dict[str, object]:
    """Return the names that the Python cells of a document use, to run the cells in a notebook.

    Everything that the document needs is read from the results of the last run.

    Parameters
    ----------
    document : str
        name of the document, such as "replication"
    show : function or None
        shows Markdown; by default it is displayed below the cell
    """
    if show is None:
        from IPython.display import Markdown, display

        def show(markdown: str) -> None:
            display(Markdown(markdown))

    project = _project_folder()
    results = project / "results"
    figures = sorted((results / "figures").glob("*.pdf"))
    files: dict[str, object] = {
        "claims": results / "claims.json",
        "findings": results / "findings.json",
        "figures": figures,
        "sources": [project / f"manuscript/{document}.md"],
        "shipped": project / "config/config.yaml",
        "citation": project / "CITATION.cff",
    }
    # The tables in NEEDS, by kind. A table of predictions belongs to each measured table.
    names_by_kind = NEEDS | {"predicted": NEEDS["measured"]}
    for kind, names in names_by_kind.items():
        # The folder of most kinds has the name of the kind.
        folder = results / FOLDERS.get(kind, kind)
        files[kind] = [folder / f"{name}.csv" for name in names]
    config = json.loads((results / "provenance.json").read_text(encoding="utf-8"))["config"]
    settings = {"config": config, "figures": [figure.stem for figure in figures]}
    return names_for(inputs_of(files, settings), show, document)


def _project_folder() -> Path:
    """Return the folder of the project that contains the working directory."""
    folder = Path.cwd()
    while not (folder / "config/config.yaml").exists():
        if folder == folder.parent:
            raise FileNotFoundError("config/config.yaml: not in this folder or above it")
        folder = folder.parent
    return folder
