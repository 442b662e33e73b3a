"""Markdown to other formats with pandoc: whole documents, or many short texts in one call."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable, Sequence

import pypandoc

RULE = "<hr />"


def pandoc(text: str, options: Sequence[str]) -> str:
    """The text as pandoc converts it.

    Parameters
    ----------
    text : what is converted
    options : of the command

    Raises
    ------
    ValueError
        If pandoc refuses the text or warns of it, with its message.
    """
    command = [pypandoc.get_pandoc_path(), "--fail-if-warnings", *options]
    done = subprocess.run(command, input=text, capture_output=True, text=True, encoding="utf-8", check=False)
    if done.returncode != 0:
        raise ValueError(f"pandoc: {done.stderr.strip()}")
    return done.stdout


def html_of(texts: Iterable[str]) -> dict[str, str]:
    """Each text, one paragraph of Markdown with formulas, as HTML with MathML; raw HTML in it is shown, not obeyed.

    Raises
    ------
    ValueError
        If a text is more than one paragraph.
    """
    texts = sorted({text for text in texts if text.strip()})
    if not texts:
        return {"": ""}
    whole = "\n\n* * *\n\n".join(" ".join(text.split()) for text in texts)
    html = pandoc(
        whole, ["--from=markdown-raw_html-smart-fancy_lists", "--to=html5", "--mathml", "--wrap=none"]
    )
    parts = [part.strip() for part in html.split(RULE)]
    if len(parts) != len(texts) or not all(
        part.startswith("<p>") and part.endswith("</p>") for part in parts
    ):
        raise ValueError("a text for a page is not one paragraph of Markdown")
    return {"": ""} | {text: part[3:-4] for text, part in zip(texts, parts, strict=True)}
