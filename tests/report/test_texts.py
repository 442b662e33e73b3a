"""The texts of the report name only what there is."""

import re
from functools import partial

import pandas as pd
import pytest
import yaml
from PIL import Image
from report.conftest import read

from slippulse.claims.reading import AS_PRINTED, WHY_NONE, claims_of, coverage
from slippulse.claims.rules import KINDS
from slippulse.report.manuscript import DOCUMENTS, NAMED, Gallery
from slippulse.report.tables import sticking
from slippulse.report.texts import ERRATUM, PARTS, Caption, parameters, read_captions, read_errata

EXPRESSION = re.compile(r"\{\{.+?\}\}", re.S)


@pytest.fixture(scope="module")
def source(manuscript) -> str:
    """Report and supplement."""
    return "\n".join((manuscript / f"{name}.md").read_text(encoding="utf-8") for name in DOCUMENTS)


@pytest.fixture(scope="module")
def captions(manuscript) -> dict[str, Caption]:
    return read_captions(manuscript / "captions.yaml")


def mentioned(text: str) -> set[str]:
    return set(re.findall(r"""\b(?:claim(?:\.(?!count\b)\w+)?|off|measured|cite)\(\s*["'](\w+)["']""", text))


@pytest.fixture(scope="module")
def entries(manuscript) -> dict[str, dict]:
    """Claims, algebra and findings."""
    return read(manuscript / "claims.yaml")


def test_every_claim_that_is_mentioned_is_in_the_ledger(source, manuscript, entries):
    names = mentioned(source)
    for entry in read_errata(manuscript / "errata.yaml"):
        # What shows it may be algebra too.
        names |= mentioned(" ".join(entry.values()))
        names |= set(re.findall(r"`(\w+)`", entry["shown"])) - set(entries["algebra"])
    summary = read(manuscript / "summary.yaml")
    for line in summary["verdict"]:
        names |= {*line["claims"], *mentioned(line["text"])}
    assert len(names) > 30
    assert names | mentioned(summary["accuracy"]) <= set(entries["claims"]) | set(entries["findings"])


def test_every_sentence_that_can_be_tested_has_a_claim_and_every_claim_a_sentence(manuscript, entries):
    statements = read(manuscript / "statements.yaml")["statements"]
    ids = [sentence["id"] for sentence in statements]
    assert len(set(ids)) == len(ids)
    tests = entries["claims"] | entries["algebra"]
    for sentence in statements:
        why = str(sentence.get("why_none", ""))
        assert bool(claims_of(tests, sentence)) != bool(why), sentence
        assert sentence.get("as_printed") in (AS_PRINTED if not why else (None,)), sentence
        assert not why or why in WHY_NONE or why.removeprefix("repeats ") in ids, sentence
        assert len(sentence["paraphrase"].split()) <= 25, sentence
    for id, entry in tests.items():
        assert entry["sentences"] and set(entry["sentences"]) <= set(ids), id
    counts = coverage(statements)
    assert counts["tested"] > 150
    assert sum(count for key, count in counts.items() if key != "all") == counts["all"] == len(statements)


def test_every_claim_is_whole_and_has_a_shipped_verdict(manuscript, entries, captions):
    for entry in entries["claims"].values():
        assert entry["statement"].endswith(".") and entry["reason"] and entry["kind"] in KINDS
        assert entry["tolerance"] >= 0.0 and entry.get("figure", "fig05_scaling") in captions
    assert set(read(manuscript / "shipped_verdicts.yaml")) == set(entries["claims"])


def test_every_erratum_is_shown(manuscript, source):
    errata = read_errata(manuscript / "errata.yaml")
    assert len(errata) >= 15
    headings = set(re.findall(r"^#+ (.+?)(?: \{.*)?$", source, re.M))
    for entry in errata:
        for title in re.findall(r'[Dd]erivation "([^"]+)"|Section "([^"]+)"', entry["shown"]):
            assert "".join(title) in headings, entry


@pytest.mark.parametrize(("reader", "keys"), [(read_captions, PARTS), (read_errata, ERRATUM)])
def test_a_text_that_is_not_whole_is_refused(reader, keys, tmp_path):
    whole = dict.fromkeys(keys, "text")
    wrong = {f"{key}: missing": whole | {key: " "} for key in keys}
    for reason, parts in (wrong | {"colour: unknown key": whole | {"colour": "red"}}).items():
        content = {"entry 1": parts} if reader is read_captions else [parts]
        (tmp_path / "texts.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
        with pytest.raises(ValueError, match=f"entry 1: {reason}"):
            reader(tmp_path / "texts.yaml")


def test_every_figure_has_one_position_and_a_caption(source, captions, project, manuscript):
    placed = NAMED.findall(source)
    modules = (project / "src/slippulse/figures").glob("*.py")
    figures = {path.stem for path in modules if path.stem.startswith(("fig", "study"))}
    assert sorted([*placed, "own_sweep"]) == sorted(captions)
    assert len(figures) >= 17 and figures <= set(placed)
    assert read(manuscript / "summary.yaml")["picture"] in figures
    assert len({caption.title for caption in captions.values()}) == len(captions)
    for name, caption in captions.items():
        # Plain text stands in headings and alternative texts; a finding is one sentence.
        assert not set("$*_{") & set(caption.title + caption.alt)
        assert caption.finding.endswith(".") and ". " not in EXPRESSION.sub(" ", caption.finding)
        text = caption.finding + caption.caption
        assert "runs(" in text or r"\Gamma=" in text or "no run" in text or name == "own_sweep", name


def test_every_citation_is_in_the_bibliography_and_every_entry_is_cited(source, manuscript):
    bibliography = (manuscript / "references.bib").read_text(encoding="utf-8")
    assert set(re.findall(r"@([A-Z]\w+)", source)) == set(re.findall(r"^@\w+\{(\w+),", bibliography, re.M))


def test_figures_are_numbered_in_the_order_of_the_text_and_keep_their_width(tmp_path):
    for name, width in {"a": 3.4, "c": 7.05, "fig05_scaling": 7.0, "new_one": 7.0}.items():
        Image.new("1", (round(100 * width), 10)).save(tmp_path / f"{name}.png", dpi=(100, 100))
    names = ("a", "b", "c", "fig05_scaling")
    captions = {name: Caption(name.upper(), "alt", "finding", "what") for name in names}
    texts = {"report": "figure('a') figure('fig05_scaling') figure('b')", "more": "figure('c')"}
    gallery = Gallery(["new_one", "c", "fig05_scaling", "a"], texts, captions, tmp_path, "report")
    assert gallery.figure("c").startswith(f"![**Figure S1. C.** finding what]({tmp_path}/c){{")
    assert gallery.figure("fig05_scaling").startswith("![**Figure 2 (paper, figure 5). FIG05_SCALING.**")
    assert "width=49%" in gallery.figure("a") and "width=100%" in gallery.figure("c")
    assert gallery.see("c", " (figure ", ")") == " ([figure S1](more.html#c))"
    assert gallery.see("a", " and ") == " and [1](#a)"
    # One without files is left out; one that the text does not place comes last, with its name.
    assert gallery.figure("b") == gallery.see("b") == ""
    assert gallery.further() == gallery.figure("new_one") and "**Figure S2. new one.**" in gallery.further()


def test_the_parameters_of_a_simulation_in_words(shipped):
    one = {"boundary": "displacement", "left": [0.3], "right": "same", "gamma": [1e-3, 0.1, 0.2, 1.0]}
    profiles = [{"left": -1.0, "right": 0.0, "width": 1.0}, {"left": -0.5, "right": 0.0, "width": 2.0}]
    two = {"boundary": "stress", "profiles": profiles, "damping_ratio": [0.0, 0.1, 0.3]}
    two |= {"beyond": {"position": 5.0, "levels": [0.1, 0.3]}}
    config = {"simulations": {"one": one, "two": two}, "model": {"damping_ratio": 0.1}}
    assert parameters(config, "one") == r"$\Gamma=1$, $\gamma$ = 0.001 to 1, $\tau_0$ = 0.3, $b$ = 0.1"
    assert parameters(config, "two") == (
        r"$\Gamma=0$, $\tau_{0,l}$ = −1 and −0.5, $\tau_{0,r}$ = 0, then $\tau$ = 0.1 and 0.3, $W$ = 1 and 2, "
        "$b$ = 0, 0.1 and 0.3"
    )
    with pytest.raises(ValueError, match="simulation: 'three'; allowed: one, two"):
        parameters(config, "three")
    for text in map(partial(parameters, shipped), shipped["simulations"]):
        assert "$b$" in text or r"$\beta$" in text


def test_every_derivation_says_where_it_starts_what_it_gives_and_where_it_is_checked(source, project):
    appendix = source[source.index("\n# Derivations") : source.index("\n# How accurate")]
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


def test_the_table_of_stick_times():
    values = {"release_time": (0.0, None), "stick_time": (3.93122803, None), "final_slip": (1.94166, 0.0)}
    table = pd.DataFrame(values, index=pd.Index([0.0, 9.0], name="x")).rename_axis(columns="quantity")
    table = table.stack(future_stack=True).rename("value").reset_index()
    found = sticking(table).splitlines()[2:]
    assert found == ["| 0 | 0 | 3.9312 | 1.9417 |", "| 9 | not measured | not measured | 0 |"]
    assert sticking(table.assign(value=float("nan"))) == ""
