"""The texts of the report name only what exists, and no number is typed into them.

Allowed in prose: the result of an expression in double braces; a formula between dollar signs in
which every number is a single digit or a power of ten (a decimal or a larger number is a result);
a reference to a numbered equation, section, figure or appendix; a citation; a name in back quotes.
Any other digit is not allowed, nor a number above three in words. In code and in expressions whole
numbers below ten (counts of digits, indices, factors) are allowed, and no others.
"""

import io
import re
import tokenize
from functools import partial
from types import SimpleNamespace

import pytest
import yaml
from PIL import Image
from report.conftest import read

from slippulse_paper.claims.claim_texts import REASONS, claims_of, coverage
from slippulse_paper.claims.ledger import KINDS, Ledger
from slippulse_paper.report import texts
from slippulse_paper.report.manuscript import DOCUMENTS, FIGURE_CALL, Gallery
from slippulse_paper.report.texts import Caption, read_captions, read_errata

# The verdict on a tested sentence as it is printed, apart from that on its claim.
AS_PRINTED = ("holds", "holds corrected", "depends on an open choice", "does not hold")
AS_PRINTED += ("open", "premise not met")
NUMBER = re.compile(
    r"\d[\d.,]*|\bper cent\b|\b(?:four|five|six|seven|eight|nine|ten|eleven|twelve|thirteen|"
    r"fourteen|fifteen|sixteen|seventeen|eighteen|nineteen|twenty|thirty|forty|fifty|sixty|"
    r"seventy|eighty|ninety|hundred|thousand|million|tenth|hundredth|thousandth|percent|dozen|"
    r"decade|quarter|fifth)s?\b",
    re.I,
)
NUMBERED = r"\(?[A-D]?\d{1,2}\)?"
REFERENCE = re.compile(
    rf"\b(?:equations?|sections?|figures?|appendix|tables?) {NUMBERED}(?:(?:, | and ){NUMBERED})*",
    re.I,
)
MATH = re.compile(r"\$\$.+?\$\$|\$[^$]+\$", re.S)
CITATION = re.compile(r"\[[^\]]*@\w+[^\]]*\]|@\w+")
NAME = re.compile(r"`([^`]+)`")
FENCE = re.compile(r"^```python[^\n]*\n(.*?)^```$", re.S | re.M)
HEADER = re.compile(r"\A---\n.*?\n---\n", re.S)
EXPRESSION = re.compile(r"\{\{(.+?)\}\}", re.S)
# Numbers in a formula that are neither a digit nor a power of ten.
in_formula = lambda formula: re.findall(r"\d+\.\d+|\d{2,}", re.sub(r"\b10\^", "", formula))
# Numbers in a name in back quotes that are not part of a word.
in_name = lambda name: re.findall(r"(?<![A-Za-z_\d])\d[\d.]*|\d+\.\d+", name)


@pytest.fixture(scope="module")
def source(manuscript) -> str:
    return "\n".join((manuscript / f"{name}.md").read_text(encoding="utf-8") for name in DOCUMENTS)


@pytest.fixture(scope="module")
def captions(manuscript) -> dict[str, Caption]:
    return read_captions(manuscript / "captions.yaml")


@pytest.fixture(scope="module")
def entries(manuscript) -> dict[str, dict]:
    return read(manuscript / "claims.yaml")


def test_page_one_answers_in_a_minute(manuscript):
    """The table has at most eight rows of 350 words in total, and a sentence at most 25 words."""
    summary = read(manuscript / "summary.yaml")
    shipped = read(manuscript / "shipped_verdicts.yaml")
    claims = [{"id": id, "kind": "exact", "verdict": verdict} for id, verdict in shipped.items()]
    lines = texts.judged_lines(summary, Ledger(claims), partial(EXPRESSION.sub, "n"))
    assert len(lines) <= 8 and summary["question"].endswith("?")
    words = [f"{line['topic']} {EXPRESSION.sub('n', line['text'])}" for line in summary["verdict"]]
    assert sum(len(text.split()) for text in words) <= 350
    sentences = texts.answer(lines).removesuffix(".").split(". ")
    assert sentences[0].startswith("**Yes**") and len(sentences) <= 3
    assert max(len(sentence.split()) for sentence in sentences) <= 25
    report = (manuscript / "replication.md").read_text(encoding="utf-8")
    page = report.partition("# What was claimed")[0]
    order = ["{{ question }}", "{{ answer }}", "{{ symbols }}"]
    order += ["show(verdicts())", "{{ accuracy }}"]
    assert sorted(order, key=page.index) == order and r"$b=\beta/\Delta x$" in summary["symbols"]
    assert page.count("claim.summary()") == 1 and "claim.count" not in page


@pytest.mark.parametrize(
    ("verdict", "expected"),
    {
        "reproduced with caveat": "**Yes**: pulses form.",
        "not reproduced": "**No**: the claim that pulses form is not reproduced.",
        "not testable": "**Not decided**: the claim that pulses form is not tested in this run.",
        "inconclusive": "**Not decided**: the claim that pulses form stays open.",
    }.items(),
)
def test_the_answer_is_yes_no_or_open_by_the_verdict_of_its_first_line(verdict, expected):
    line = {"topic": "Pulses", "named": "pulses form", "claims": {"first": "pulses"}, "text": ""}
    ledger = Ledger([{"id": "first", "kind": "exact", "verdict": verdict}])
    assert texts.answer(texts.judged_lines({"verdict": [line]}, ledger, str)) == expected


def test_the_index_has_at_most_twelve_statements_of_one_line(manuscript):
    summary = read(manuscript / "summary.yaml")
    shipped = read(manuscript / "shipped_verdicts.yaml")
    assert len(summary["statements"]) <= 12
    for row in summary["statements"]:
        assert row["claims"] and set(row["claims"]) <= shipped.keys()
        # An expression becomes a few characters; a line on a wide screen has room for so many.
        number = EXPRESSION.sub("12 %", row["number"])
        assert len(row["statement"]) <= 65 and len(number) <= 78, row
        # The words and symbols are explained below the table.
        assert "$" not in row["statement"] + row["number"]


def test_every_tested_sentence_has_a_claim_and_every_claim_a_sentence(manuscript, entries):
    statements = read(manuscript / "statements.yaml")["statements"]
    ids = [sentence["id"] for sentence in statements]
    assert len(set(ids)) == len(ids)
    untested = {*REASONS} - {"tested", "repeats"}
    tests = entries["claims"] | entries["algebra"] | entries["imposed"]
    for sentence in statements:
        why = str(sentence.get("why_none", ""))
        assert bool(claims_of(tests, sentence)) != bool(why), sentence
        assert sentence.get("as_printed") in (AS_PRINTED if not why else (None,)), sentence
        assert not why or why in untested or why.removeprefix("repeats ") in ids, sentence
        assert len(sentence["paraphrase"].split()) <= 25, sentence
    for id, entry in tests.items():
        assert entry["sentences"] or entry.get("beyond"), id
        assert set(entry["sentences"]) <= set(ids), id
    counts = coverage(statements)
    assert counts["tested"] > 150
    assert sum(counts.values()) == 2 * counts["all"]


def test_every_claim_is_whole_and_has_a_shipped_verdict(manuscript, entries, captions):
    for entry in entries["claims"].values():
        assert entry["statement"].endswith(".") and entry["reason"] and entry["kind"] in KINDS
        assert entry["tolerance"] >= 0.0 and entry.get("figure", "fig05_scaling") in captions
    assert set(read(manuscript / "shipped_verdicts.yaml")) == set(entries["claims"])


def test_every_erratum_is_shown_and_the_bibliography_is_what_is_cited(manuscript, source, entries):
    errata = read_errata(manuscript / "errata.yaml")
    known = entries["claims"] | entries["findings"] | entries["algebra"] | entries["imposed"]
    assert len(errata) >= 15
    headings = set(re.findall(r"^#+ (.+?)(?: \{.*)?$", source, re.M))
    for entry in errata:
        assert known.keys() >= {*re.findall(r"`(\w+)`", entry["shown"])}, entry
        for title in re.findall(r'[Dd]erivation "([^"]+)"|Section "([^"]+)"', entry["shown"]):
            assert "".join(title) in headings, entry
    bibliography = (manuscript / "references.bib").read_text(encoding="utf-8")
    assert known.keys() >= {*re.findall(r"""\bcite\(["'](\w+)""", source)}
    cited = set(re.findall(r"@([A-Z]\w+)", source))
    assert cited == set(re.findall(r"^@\w+\{(\w+),", bibliography, re.M))


@pytest.mark.parametrize("reader", [read_captions, read_errata])
def test_a_text_that_is_not_whole_is_refused(reader, tmp_path):
    keys = Caption._fields if reader is read_captions else texts.ERRATUM
    complete = dict.fromkeys(keys, "text")
    wrong = {f"{key}: missing": complete | {key: " "} for key in keys}
    wrong["colour: unknown key"] = complete | {"colour": "red"}
    for reason, parts in wrong.items():
        content = {"entry 1": parts} if reader is read_captions else [parts]
        (tmp_path / "texts.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
        with pytest.raises(ValueError, match=f"entry 1: {reason}"):
            reader(tmp_path / "texts.yaml")


def test_every_figure_has_one_position_and_a_caption(source, captions, project, manuscript):
    placed = FIGURE_CALL.findall(source)
    modules = (project / "src/slippulse_paper/figures").glob("*.py")
    figures = {path.stem for path in modules if path.stem.startswith(("fig", "study"))}
    assert sorted([*placed, "user_defined_sweep"]) == sorted(captions)
    assert len(figures) >= 17 and figures <= set(placed)
    assert sum(name.startswith("fig") for name in figures) == 11
    assert len({caption.title for caption in captions.values()}) == len(captions)
    for name, caption in captions.items():
        # Plain text stands in headings and alternative texts; a finding is one sentence.
        assert not set("$*_{") & set(caption.title + caption.alt)
        assert caption.finding.endswith(".") and ". " not in EXPRESSION.sub(" ", caption.finding)
        text = f"{caption.finding} {caption.caption}"
        words = re.findall(r"[^\W\d_][\w'-]+", MATH.sub(" ", EXPRESSION.sub(" ", text)))
        assert 20 < len(words) <= 120, name
        says_runs = any(part in text for part in ("runs(", r"\Gamma=", "no run"))
        assert says_runs or name == "user_defined_sweep", name


def test_figures_are_numbered_in_the_order_of_the_text_and_keep_their_width(tmp_path):
    for name, width in {"a": 3.4, "c": 7.05, "fig05_scaling": 7.0, "new_one": 7.0}.items():
        Image.new("1", (round(100 * width), 10)).save(tmp_path / f"{name}.png", dpi=(100, 100))
    names = ("a", "b", "c", "fig05_scaling")
    captions = {name: Caption(name.upper(), "alt", "finding", "what") for name in names}
    sources = {"report": "figure('a') figure('fig05_scaling') figure('b')", "more": "figure('c')"}
    drawn = ["new_one", "c", "fig05_scaling", "a"]
    inputs = SimpleNamespace(figures=drawn, figures_folder=tmp_path)
    gallery = Gallery(inputs, sources, captions, "report")
    assert gallery.figure("c").startswith(f"![**Figure S1. C.** finding what]({tmp_path}/c){{")
    title = "![**Figure 2 (paper, figure 5). FIG05_SCALING.**"
    assert gallery.figure("fig05_scaling").startswith(title)
    assert "width=49%" in gallery.figure("a") and "width=100%" in gallery.figure("c")
    assert gallery.see("c", " (figure ", ")") == " ([figure S1](more.html#c))"
    assert gallery.see("a", " and ") == " and [1](#a)"
    # One without files is left out; one that the text does not place comes last, with its name.
    assert gallery.figure("b") == gallery.see("b") == ""
    assert gallery.further() == gallery.figure("new_one")
    assert "**Figure S2. new one.**" in gallery.further()


def test_the_parameters_of_a_simulation_in_words(shipped):
    one = {"boundary": "displacement", "left": [0.3], "right": "same"}
    one |= {"gamma": [1e-3, 0.1, 0.2, 1.0]}
    profiles = [{"left": -1.0, "right": 0.0, "width": 1.0}]
    profiles += [{"left": -0.5, "right": 0.0, "width": 2.0}]
    two = {"boundary": "stress", "profiles": profiles, "damping_ratio": [0.0, 0.1, 0.3]}
    two |= {"beyond": {"position": 5.0, "levels": [0.1, 0.3]}}
    config = {"simulations": {"one": one, "two": two}, "model": {"damping_ratio": 0.1}}
    words = r"$\Gamma=1$, $\gamma$ = 0.001 to 1, $\tau_0$ = 0.3, $b$ = 0.1"
    assert texts.parameters(config, "one") == words
    words = r"$\Gamma=0$, $\tau_{0,l}$ = −1 and −0.5, $\tau_{0,r}$ = 0, then $\tau$ = 0.1 and 0.3, "
    words += "$W$ = 1 and 2, $b$ = 0, 0.1 and 0.3"
    assert texts.parameters(config, "two") == words
    words = r"$\Gamma=0$, $\tau_{0,l}$ = −1, $\tau_{0,r}$ = 0, then $\tau$ = 0.1, $W$ = 1, $b$ = 0"
    assert texts.parameters(config, "two", first=True) == words
    # A profile without a Gaussian has no width.
    config["simulations"]["two"] |= {"profiles": [{"width": None}, {"width": 2.0}]}
    assert "$W$ = 2, $b$" in texts.parameters(config, "two")
    with pytest.raises(ValueError, match="simulation: 'three'; allowed: one, two"):
        texts.parameters(config, "three")
    for text in map(partial(texts.parameters, shipped), shipped["simulations"]):
        assert "$b$" in text or r"$\beta$" in text


def test_every_derivation_says_where_it_starts_and_is_checked(source, project):
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
    for name in referred:
        assert [title for title in titles if title.startswith(name)], name


def in_code(code: str) -> list[str]:
    """Return numbers in Python except small whole ones, and digits in its strings outside names."""
    numbers = []
    for token in tokenize.generate_tokens(io.StringIO(code.strip()).readline):
        if token.type == tokenize.NUMBER and not re.fullmatch(r"\d", token.string):
            numbers.append(token.string)
        if token.type in (tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", -1)):
            numbers += re.findall(r"\d\S*", re.sub(r"[A-Za-z_]\w*", "", token.string))
    return numbers


def in_prose(text: str) -> list[str]:
    """Return numbers typed into Markdown outside code cells, each with the words around it."""
    numbers = []
    checks = {EXPRESSION: in_code, MATH: in_formula, CITATION: None, NAME: in_name, REFERENCE: None}
    for pattern, check in checks.items():
        for match in pattern.finditer(text) if check else ():
            numbers += check(match[match.lastindex or 0])
        text = pattern.sub(" ", text)
    for match in NUMBER.finditer(text):
        numbers.append(" ".join(text[max(0, match.start() - 30) : match.end() + 20].split()))
    return numbers


def typed_numbers(source: str) -> list[str]:
    """Return the numbers typed into a Markdown source of jupytext."""
    source = HEADER.sub("", source)
    return in_code("\n".join(FENCE.findall(source))) + in_prose(FENCE.sub(" ", source))


# Numbers of each kind that must be found.
TYPED = (
    "The front runs at 1.25 wave speeds.",
    "It takes eleven figures.",
    "The speed is $v = 1.25$.",
    "After $T = 39$ it stops.",
    "It is `1.25` exactly.",
    "The speed is {{ 1.25 | number }}.",
    "```python\nshow('the speed is 5')\n```\n",
    "```python\nspeed = 1.25\n```\n",
    "```python\nshow(f'{speed} is 5 more')\n```\n",
)


def test_no_text_has_a_typed_number(manuscript):
    for name in DOCUMENTS:
        assert typed_numbers((manuscript / f"{name}.md").read_text(encoding="utf-8")) == []
    entries = [*read(manuscript / "errata.yaml"), *read(manuscript / "captions.yaml").values()]
    summary = read(manuscript / "summary.yaml")
    for line in summary["verdict"]:
        entries.append({key: line[key] for key in ("topic", "named", "text")})
        entries += [line.get("said", {}), line["claims"], line.get("beside", {})]
    entries.append({key: summary[key] for key in ("question", "symbols", "accuracy")})
    entries += [{key: row[key] for key in ("statement", "number")} for row in summary["statements"]]
    entries += summary["words"]
    for entry in entries:
        assert list(filter(None, map(in_prose, entry.values()))) == []
    for text in TYPED:
        assert typed_numbers(text), text
