"""Run the jupytext source of the report in a kernel of this environment and collect the Markdown that it shows."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import jupytext
import nbformat
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from traitlets.config import Config

from .inputs import VARIABLE, Inputs

# Seconds that one cell may take.
CELL_TIMEOUT = 120
# A socket's path may have some hundred characters; below a longer folder the kernel listens on a local port instead.
LONGEST_SOCKET_FOLDER = 80


class OwnSpecs(KernelSpecManager):
    """One kernel: the running interpreter, whatever kernels the user has installed."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        """Start the interpreter that runs this."""
        argv = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=argv, display_name="slippulse", language="python")


class OwnKernel(AsyncKernelManager):
    """Manages that kernel."""

    def __init__(self, **options) -> None:
        super().__init__(kernel_spec_manager=OwnSpecs(), **options)


def executable(source: str | Path) -> nbformat.NotebookNode:
    """The notebook of a jupytext source, its prose as cells that show themselves.

    Parameters
    ----------
    source : file in any format of jupytext
    """
    notebook = jupytext.read(source)
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            cell.cell_type = "code"
            cell.source = f"prose({cell.source!r})"
            cell.outputs, cell.execution_count = [], None
    return notebook


def execute(source: str | Path, inputs: Inputs) -> str:
    """Execute the report.

    Parameters
    ----------
    source : jupytext source
    inputs : what it is written from

    Returns
    -------
    the Markdown that its cells showed, in order

    Raises
    ------
    ValueError
        If a cell fails: the error and the first line of the cell.
    """
    notebook = executable(source)
    with tempfile.TemporaryDirectory(prefix="slippulse-report-") as folder:
        listed = Path(folder) / "inputs.json"
        inputs.write(listed)
        # Nothing of the user's own IPython or Jupyter set-up takes part.
        environment = os.environ | {
            VARIABLE: str(listed),
            "IPYTHONDIR": str(Path(folder) / "ipython"),
            "JUPYTER_RUNTIME_DIR": str(Path(folder) / "runtime"),
            "JUPYTER_CONFIG_DIR": str(Path(folder) / "config"),
            "PYDEVD_DISABLE_FILE_VALIDATION": "1",
        }
        settings = {"connection_file": str(Path(folder) / "kernel.json")}
        if len(folder) <= LONGEST_SOCKET_FOLDER:
            settings |= {"transport": "ipc", "ip": str(Path(folder) / "kernel")}
        client = NotebookClient(
            notebook,
            kernel_manager_class=OwnKernel,
            config=Config({"OwnKernel": settings}),
            timeout=CELL_TIMEOUT,
        )
        try:
            client.execute(env=environment, cwd=folder)
        except CellExecutionError as error:
            raise ValueError(f"{Path(source).name}: {error.evalue} ({_failed(notebook)})") from None
    return "\n\n".join(_shown(notebook)) + "\n"


def _failed(notebook: nbformat.NotebookNode) -> str:
    for cell in notebook.cells:
        if any(output.output_type == "error" for output in cell.outputs):
            line = cell.source.strip().splitlines()[0]
            return f"cell {line[:70]!r}"
    return "no cell"


def _shown(notebook: nbformat.NotebookNode) -> list[str]:
    return [
        output.data["text/markdown"]
        for cell in notebook.cells
        if cell.cell_type == "code"
        for output in cell.outputs
        if output.output_type == "display_data" and "text/markdown" in output.data
    ]
