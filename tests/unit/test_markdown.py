"""Texts of a user in pages and in the report: formulas and links to the web act, nothing else."""

import os
import re
from pathlib import Path

import pytest

from slippulse_paper.text import markdown
from slippulse_paper.text.markdown import harmless, is_readable, markup_of, pandoc

HOSTILE = (
    '[x](javascript:alert(4)) [y]{onmouseover=alert(1) style="position:fixed"}',
    "![z](http://doi.org/z.png) ![](file:///z.png){width=1} [u](data:text/html,a)",
    "<javascript:alert(1)> <b onclick=alert(1)>bold</b> <a@doi.org>",
    "`<script>alert(1)</script>`{=html} ::: {.a onload=x} \\input{secret} \\(x\\)",
    "[a]: javascript:alert(2) 'title' and [a] | a cell ^[note] @Nobody2000 # no heading",
)
ACTIVE = re.compile(r"<(?!/?(p|em|strong|code|span)>)[^>]*>")


@pytest.mark.parametrize("text", HOSTILE)
@pytest.mark.parametrize("prepared", [str, harmless])
def test_nothing_of_a_users_text_acts_in_a_page(text, prepared):
    text = prepared(text)
    html = markup_of([f"10; {text}"])[f"10; {text}"]
    assert not ACTIVE.search(html), html


@pytest.mark.parametrize("text", HOSTILE)
def test_a_harmless_text_is_shown_as_it_was_written_in_the_report_too(text):
    table = f"| a | b |\n|:--|:--|\n| {harmless(text)} | end |\n"
    for to, cell in (("html5", "<td"), ("typst", "[end]")):
        written = pandoc(table, "markdown", to, ["--citeproc", "--mathml"])
        assert written.count(cell) == (2 if to == "html5" else 1)
        assert not re.search(r"(?<!\\)<(script|b|img|a|span)\b|#link|#image|#cite", written), (
            written
        )
    shown = pandoc(harmless(text), "markdown-smart", "plain", ["--wrap=none"])
    assert shown.strip() == " ".join(text.split())


def test_formulas_emphasis_and_links_to_the_web_stay():
    text = r"*front* at $T_\mathrm{trans}<5$, see [the paper](https://doi.org/10.1103/x_y?a=b)"
    assert harmless(text) == text
    html = markup_of([text])[text]
    assert "<em>front</em>" in html and "<math" in html
    assert '<a href="https://doi.org/10.1103/x_y?a=b">the paper</a>' in html


def test_no_shipped_statement_is_changed(shipped):
    for reading in shipped["published"].values():
        assert harmless(reading["statement"]) == reading["statement"]


def test_a_text_without_formulas_is_allowed_without_pandoc(monkeypatch):
    assert is_readable("at $x=1$") and not is_readable(r"at $\frac{1}{$")
    monkeypatch.setattr(markdown, "pandoc", None)
    assert is_readable("plain {text} with [signs]")


def test_the_pandoc_of_the_lock_is_used_without_settings_of_the_user(tmp_path, monkeypatch):
    other = tmp_path / "pandoc"
    other.write_text("#!/bin/sh\necho other\n", encoding="utf-8")
    other.chmod(0o755)
    (tmp_path / "share/pandoc").mkdir(parents=True)
    (tmp_path / "share/pandoc/default.csl").write_text("not a style", encoding="utf-8")
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYPANDOC_PANDOC", str(other))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "share"))
    assert markup_of(["*a*"])["*a*"] == "<em>a</em>"
    text = "---\nreferences: [{id: a, title: A title, type: book}]\n---\n[@a]"
    style = Path(markdown.__file__).parents[1] / "report/templates/report.csl"
    for options in ([], [f"--csl={style}"]):
        assert "A Title" in pandoc(text, "markdown", "plain", ["--citeproc", *options])
