"""No number is typed into the report: the rule as code, and the texts that keep it.

Allowed in prose: what an expression in double braces computes; a formula between dollar signs, if every number in it is
a single digit or a power of ten (a decimal or a larger number is a result); a reference to a numbered equation,
section, figure or appendix; a citation; a name in back quotes. Not allowed: any other digit, and a number above three
in words.
In code and in expressions, whole numbers below ten (counts of digits, indices, factors) and no others.
"""

import io
import re
import tokenize

import pytest
from report.conftest import read

from slippulse.report.manuscript import DOCUMENTS

WORDS = (
    r"four|five|six|seven|eight|nine|ten|eleven|twelve|thirteen|fourteen|fifteen|"
    r"sixteen|seventeen|eighteen|nineteen|twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety|"
    r"hundred|thousand|million|tenth|hundredth|thousandth|percent|dozen|decade|quarter|fifth"
)
WORD = re.compile(rf"\b(?:{WORDS})s?\b|\bper cent\b", re.I)
NUMBERED = r"\(?[A-D]?\d{1,2}\)?"
REFERENCE = re.compile(
    rf"\b(?:equations?|sections?|figures?|appendix|tables?) {NUMBERED}(?:(?:, | and ){NUMBERED})*", re.I
)
EXPRESSION = re.compile(r"\{\{(.+?)\}\}", re.S)
MATH = re.compile(r"\$\$.+?\$\$|\$[^$]+\$", re.S)
CITATION = re.compile(r"\[[^\]]*@\w+[^\]]*\]|@\w+")
NAME = re.compile(r"`([^`]+)`")
FENCE = re.compile(r"^```python[^\n]*\n(.*?)^```$", re.S | re.M)
HEADER = re.compile(r"\A---\n.*?\n---\n", re.S)


def in_prose(text: str) -> list[str]:
    """Numbers typed into Markdown without code cells, each with what surrounds it."""
    found = []
    for pattern, check in (
        (EXPRESSION, in_code),
        (MATH, lambda formula: re.findall(r"\d+\.\d+|\d{2,}", re.sub(r"\b10\^", "", formula))),
        (CITATION, lambda _: []),
        (NAME, lambda name: re.findall(r"(?<![A-Za-z_\d])\d[\d.]*|\d+\.\d+", name)),
        (REFERENCE, lambda _: []),
    ):
        for match in pattern.finditer(text):
            found += check(match[match.lastindex or 0])
        text = pattern.sub(" ", text)
    for match in re.finditer(rf"\d[\d.,]*|{WORD.pattern}", text, re.I):
        found.append(" ".join(text[max(0, match.start() - 30) : match.end() + 20].split()))
    return found


def in_code(code: str) -> list[str]:
    """Numbers other than small whole ones in Python, and digits in its strings that are not part of a name."""
    found = []
    for token in tokenize.generate_tokens(io.StringIO(code.strip()).readline):
        if token.type == tokenize.NUMBER and not re.fullmatch(r"\d", token.string):
            found.append(token.string)
        if token.type in (tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", -1)):
            found += re.findall(r"\d\S*", re.sub(r"[A-Za-z_]\w*", "", token.string))
    return found


def typed_numbers(source: str) -> list[str]:
    """Numbers typed into a jupytext Markdown source."""
    source = HEADER.sub("", source)
    found = [number for code in FENCE.findall(source) for number in in_code(code)]
    return found + in_prose(FENCE.sub(" ", source))


def test_no_text_has_a_typed_number(manuscript):
    for name in DOCUMENTS:
        assert typed_numbers((manuscript / f"{name}.md").read_text(encoding="utf-8")) == []
    texts = [text for entry in read(manuscript / "errata.yaml") for text in entry.values()]
    texts += [text for parts in read(manuscript / "captions.yaml").values() for text in parts.values()]
    summary = read(manuscript / "summary.yaml")
    texts += [
        summary["accuracy"],
        *(line[key] for line in summary["verdict"] for key in ("topic", "named", "text")),
    ]
    assert [number for text in texts for number in in_prose(text)] == []


TYPED = (
    "The front runs at 1.25 wave speeds.", "We made 81 runs.", "It deviates by 7 %.", "It takes eleven figures.",
    "It is off by ten per cent.", "The speed is $v = 1.25$.", "After $T = 39$ it stops.", "It is `1.25` exactly.",
    "The speed is {{ 1.25 | number }}.", "The speed is {{ (claim.measured('x') + 12) | number }}.",
    "```python\nshow('the speed is 5')\n```\n", "```python\nspeed = 1.25\n```\n",
    "```python\nshow(f'{speed} is 5 more')\n```\n", "In 2021 it was found.",
)  # fmt: skip
ALLOWED = (
    r"By equations (B9), (B11) and (5) the damping $\beta=10^{-3}$ is $1/\sqrt{1-\tau_0^2}$.",
    "Known [@Amundsen2015] from figure 4 and section 3.",
    "The claim `published_trailing_edge_5` is {{ claim('a_1').measured | number(3) }}.",
    "```python\nfigure('fig05_scaling')\nx = 2 * y\n```\n",
)


@pytest.mark.parametrize("text", [*TYPED, *ALLOWED])
def test_a_typed_number_is_found_and_a_formula_reference_or_expression_is_none(text):
    assert bool(typed_numbers(text)) == (text in TYPED)
