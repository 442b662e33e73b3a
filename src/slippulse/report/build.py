"""The replication report, from the ledger and the figures to HTML and PDF."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from pathlib import Path

import yaml

from ..data.files import write_whole
from .execute import execute
from .inputs import Inputs
from .notebook import SOURCE
from .render import render_html, render_pdf

HEAD = (
    "# Verdict of each claim. manuscript/shipped_verdicts.yaml is a copy from the run of the shipped one.\n"
)


def build_report(inputs: Inputs, outputs: Mapping[str, str | Path]) -> None:
    """Execute the manuscript and write it as HTML and PDF, with the verdicts beside.

    Parameters
    ----------
    inputs : what it is written from
    outputs : files for `html`, `pdf`, and `verdicts`, the verdict of each claim

    Raises
    ------
    ValueError
        If a cell fails, a text is not whole, or pandoc or Typst refuse it.
    """
    text = execute(Path(inputs.manuscript) / SOURCE, inputs)
    with ThreadPoolExecutor() as pool:
        # Both wait for processes of their own, so they overlap.
        renderings = [
            pool.submit(copy_context().run, render, text, inputs.manuscript, outputs[kind])
            for kind, render in (("html", render_html), ("pdf", render_pdf))
        ]
    for rendering in renderings:
        rendering.result()
    verdicts = yaml.safe_dump({claim["id"]: claim["verdict"] for claim in inputs.claims}, sort_keys=False)
    write_whole(outputs["verdicts"], lambda part: part.write_text(HEAD + verdicts, encoding="utf-8"))
