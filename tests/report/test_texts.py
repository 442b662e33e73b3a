"""The texts of the report name only what there is."""

from __future__ import annotations

import re
from functools import partial

import pytest
import yaml
from PIL import Image
from slippulse.report.accuracy import sticking
from slippulse.report.captions import PARTS, Caption, read_captions
from slippulse.report.errata import KEYS, check_errata
from slippulse.report.figures import Gallery, placed_figures

from slippulse import Prestress
from slippulse.claims.coverage import coverage, problems
from slippulse.configuration.parameters import parameters
from slippulse.theory import Rupture

EXPRESSION = re.compile(r"\{\{.+?\}\}", re.S)


@pytest.fixture(scope="module")
def source(manuscript) -> str:
    return (manuscript / "replication.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def errata(manuscript) -> list[dict]:
    return yaml.safe_load((manuscript / "errata.yaml").read_text(encoding="utf-8"))


def mentioned(text: str) -> set[str]:
    return set(re.findall(r"""\bclaim(?:\.(?!count\b)\w+)?\(\s*["'](\w+)["']""", text))


def test_every_claim_that_is_mentioned_is_in_the_ledger(source, errata, shipped):
    names = mentioned(source)
    for entry in errata:
        names |= mentioned(" ".join(entry.values()))
        names |= set(re.findall(r"`(\w+)`", entry["shown"]))
    assert len(names) > 30
    assert names <= set(shipped["claims"])


def test_every_sentence_that_can_be_tested_has_a_claim_and_every_claim_a_sentence(manuscript, shipped):
    statements = yaml.safe_load((manuscript / "statements.yaml").read_text(encoding="utf-8"))["statements"]
    assert problems(statements, list(shipped["claims"])) == []
    counts = coverage(statements)
    assert counts["tested"] > 150
    assert sum(count for key, count in counts.items() if key != "all") == counts["all"] == len(statements)


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"claim": "no_such"}, "a: no_such: no such claim"),
        ({"claim": None}, "a: allowed: a claim, or why there is none"),
        ({"why_none": "background"}, "a: allowed: a claim, or why there is none"),
        ({"claim": None, "why_none": "too hard"}, "a: 'too hard'; allowed: background"),
        ({"claim": None, "why_none": "repeats b"}, "a: 'repeats b'; allowed: background"),
        ({"claim": None, "why_none": "no model"}, "c: tests no sentence"),
        ({"paraphrase": "word " * 26}, "a: paraphrase of more than 25 words"),
    ],
)
def test_a_gap_in_the_map_is_found(changed, problem):
    sentence = {"id": "a", "place": "section I", "paraphrase": "so it is", "claim": "c"}
    assert problems([sentence], ["c"]) == []
    sentence = {key: value for key, value in (sentence | changed).items() if value is not None}
    assert any(line.startswith(problem) for line in problems([sentence], ["c"]))


def test_every_claim_has_a_text(manuscript, shipped):
    texts = yaml.safe_load((manuscript / "claims.yaml").read_text(encoding="utf-8"))
    assert list(texts["claims"]) == list(shipped["claims"])
    figures = set(read_captions(manuscript / "captions.yaml"))
    for text in texts["claims"].values():
        assert set(text) <= {"statement", "figure"} and text["statement"].endswith(".")
        assert text.get("figure", "fig05_scaling") in figures


def test_every_erratum_is_whole_and_shown(errata, source):
    check_errata(errata)
    assert len(errata) >= 15
    headings = set(re.findall(r"^#+ (.+?)(?: \{.*)?$", source, re.M))
    for entry in errata:
        for title in re.findall(r'[Dd]erivation "([^"]+)"|Section "([^"]+)"', entry["shown"]):
            assert "".join(title) in headings, entry


@pytest.mark.parametrize("key", KEYS)
def test_an_erratum_that_is_not_whole_is_refused(key):
    entry = {name: "text" for name in KEYS} | {key: " "}
    with pytest.raises(ValueError, match=f"entry 1: {key}: missing"):
        check_errata([entry])


def test_every_figure_has_one_place_and_a_caption(source, manuscript):
    captions = read_captions(manuscript / "captions.yaml")
    placed = placed_figures(source)
    assert sorted([*placed, "own_sweep"]) == sorted(captions)
    titles = [caption.title for caption in captions.values()]
    assert len(set(titles)) == len(titles)
    for caption in captions.values():
        # Plain text stands in headings and alternative texts; a finding is one sentence.
        assert not set("$*_{") & set(caption.title + caption.alt)
        assert caption.finding.endswith(".") and ". " not in EXPRESSION.sub(" ", caption.finding)


@pytest.mark.parametrize("key", PARTS)
def test_a_caption_that_is_not_whole_is_refused(key, tmp_path):
    parts = {name: "text" for name in PARTS} | {key: " "}
    (tmp_path / "captions.yaml").write_text(yaml.safe_dump({"one": parts}), encoding="utf-8")
    with pytest.raises(ValueError, match=f"one: {key}: missing"):
        read_captions(tmp_path / "captions.yaml")


def test_a_caption_with_another_key_is_refused(tmp_path):
    parts = {name: "text" for name in PARTS} | {"colour": "red"}
    (tmp_path / "captions.yaml").write_text(yaml.safe_dump({"one": parts}), encoding="utf-8")
    with pytest.raises(ValueError, match="one: colour: unknown key"):
        read_captions(tmp_path / "captions.yaml")


def test_the_summary_is_five_lines_about_claims_and_figures_that_there_are(manuscript, shipped):
    summary = yaml.safe_load((manuscript / "summary.yaml").read_text(encoding="utf-8"))
    assert len(summary["verdict"]) == 5
    assert summary["picture"] in read_captions(manuscript / "captions.yaml")
    for line in summary["verdict"]:
        assert {*line["claims"], *mentioned(line["text"])} <= set(shipped["claims"])
    assert mentioned(summary["accuracy"]) <= set(shipped["claims"])


def test_the_shipped_verdicts_are_of_the_claims(manuscript, shipped):
    verdicts = yaml.safe_load((manuscript / "shipped_verdicts.yaml").read_text(encoding="utf-8"))
    assert set(verdicts) == set(shipped["claims"])


def test_every_citation_is_in_the_bibliography_and_every_entry_is_cited(source, manuscript):
    entries = set(
        re.findall(r"^@\w+\{(\w+),", (manuscript / "references.bib").read_text(encoding="utf-8"), re.M)
    )
    assert set(re.findall(r"@([A-Z]\w+)", source)) == entries


def drawn(folder, **inches: float) -> str:
    """A folder with pictures so many inches wide."""
    for name, width in inches.items():
        Image.new("1", (round(100 * width), 10)).save(folder / f"{name}.png", dpi=(100, 100))
    return str(folder)


def test_a_figure_of_one_column_is_one_in_the_report(tmp_path):
    gallery = Gallery(["column", "page"], [], {}, drawn(tmp_path, column=3.4, page=7.05))
    assert "width=49%" in gallery.figure("column") and "width=100%" in gallery.figure("page")


def test_a_figure_that_the_text_does_not_place_comes_last(tmp_path):
    gallery = Gallery(["new_one", "a"], ["a"], {"a": caption("text")}, drawn(tmp_path, new_one=7.0))
    assert gallery.unplaced == ["new_one"]
    assert "**Figure 2. new one.**" in gallery.figure("new_one")


def test_every_figure_of_the_package_has_a_place(project, source):
    modules = (project / "src/slippulse/figures").glob("*.py")
    figures = {path.stem for path in modules if path.stem.startswith(("fig", "study"))}
    assert len(figures) >= 17
    assert figures <= set(placed_figures(source))


def test_a_figure_of_the_paper_says_which(tmp_path):
    gallery = Gallery(
        ["fig05_scaling"], [], {"fig05_scaling": caption("text")}, drawn(tmp_path, fig05_scaling=7.0)
    )
    assert gallery.figure("fig05_scaling").startswith("![**Figure 1 (paper, figure 5). text.**")


def test_every_caption_names_boundary_and_parameters(manuscript):
    captions = read_captions(manuscript / "captions.yaml")
    del captions["own_sweep"]
    for name, caption in captions.items():
        text = caption.finding + caption.caption
        assert "runs(" in text or r"\Gamma=" in text or "no run" in text, name


def test_the_parameters_of_a_simulation_in_words(shipped):
    config = {
        "simulations": {
            "one": {
                "boundary": "displacement",
                "left": [0.3],
                "right": "same",
                "gamma": [1e-3, 0.1, 0.2, 1.0],
            },
            "two": {
                "boundary": "stress",
                "profiles": [
                    {"left": -1.0, "right": 0.0, "width": 1.0},
                    {"left": -0.5, "right": 0.0, "width": 2.0},
                ],
                "beyond": {"position": 5.0, "levels": [0.1, 0.3]},
                "damping_ratio": [0.0, 0.1, 0.3],
            },
        },
        "model": {"damping_ratio": 0.1},
    }
    assert parameters(config, "one") == r"$\Gamma=1$, $\gamma$ = 0.001 to 1, $\tau_0$ = 0.3, $b$ = 0.1"
    assert parameters(config, "two") == (
        r"$\Gamma=0$, $\tau_{0,l}$ = −1 and −0.5, $\tau_{0,r}$ = 0, then $\tau$ = 0.1 and 0.3, $W$ = 1 and 2, "
        "$b$ = 0, 0.1 and 0.3"
    )
    with pytest.raises(ValueError, match="simulation: 'three'; allowed: one, two"):
        parameters(config, "three")
    assert all(
        "$b$" in text or r"$\beta$" in text
        for text in map(partial(parameters, shipped), shipped["simulations"])
    )


def test_every_derivation_says_where_it_starts_what_it_gives_and_where_it_is_checked(source, project):
    appendix = source[source.index("# Appendix: derivations") : source.index("# Appendix: the solver")]
    derivations = appendix.split("\n## ")[1:]
    assert len(derivations) >= 10
    for text in derivations:
        first = text.split("\n\n")[1]
        assert re.match(r"\*Starts from\*.*\*Gives\*.*\*Checked\*", first, re.S), text[:60]
    for path in re.findall(r"`(tests/[\w/.]+)`", appendix):
        assert (project / path).exists(), path
    titles = [text.partition(" {")[0] for text in derivations]
    referred = re.findall(r'derivations? "([^"]+)"', source)
    assert len(referred) >= 4
    assert all(any(title.startswith(name) for title in titles) for name in referred)


def test_figures_are_numbered_in_the_order_of_the_text(tmp_path):
    captions = {name: caption(name.upper()) for name in "abc"}
    gallery = Gallery(["c", "a"], ["a", "b", "c"], captions, drawn(tmp_path, a=7.0, c=7.0))
    assert gallery.figure("c").startswith(f"![**Figure 2. C.** finding what]({tmp_path}/c){{")
    assert gallery.see("c", " (figure ", ")") == " ([figure 2](#c))"
    assert gallery.see("c", " and ") == " and [2](#c)"
    assert gallery.figure("b") == gallery.see("b") == ""


def caption(title: str) -> Caption:
    return Caption(title, "alt", "finding", "what")


def test_the_table_of_stick_times():
    rows = sticking(Rupture(Prestress(0.25, 0.25), 0.55, 0.1, duration=5.0), [0, 9]).splitlines()[2:]
    assert rows == ["| 0 | 0 | 3.9312 | 1.9417 |", "| 9 | not measured | not measured | 0 |"]
    assert sticking(None, [0]) == ""
