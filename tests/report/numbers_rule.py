"""The rule that no number is typed into the report, as code.

Allowed in prose: what an expression in double braces computes; a formula between dollar signs, if every number in it is
a single digit or a power of ten (a decimal or a larger number is a result); a reference to a numbered equation,
section, figure or appendix; a citation; a name in back quotes. Not allowed: any other digit, and a number above three
in words.
In code and in expressions, whole numbers below ten (counts of digits, indices, factors) and no others.
"""

from __future__ import annotations

import io
import re
import tokenize

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
FENCE = re.compile(r"^```python[^\n]*\n(.*?)^```$", re.S | re.M)
HEADER = re.compile(r"\A---\n.*?\n---\n", re.S)


def typed_numbers_in_prose(text: str) -> list[str]:
    """Numbers typed into Markdown without code cells, each with what surrounds it."""
    found = []

    def take(pattern: re.Pattern, check) -> None:
        nonlocal text
        for match in pattern.finditer(text):
            found.extend(check(match[match.lastindex or 0]))
        text = pattern.sub(" ", text)

    take(EXPRESSION, typed_numbers_in_code)
    take(MATH, _in_formula)
    take(CITATION, lambda _: [])
    take(re.compile(r"`([^`]+)`"), lambda name: re.findall(r"(?<![A-Za-z_\d])\d[\d.]*|\d+\.\d+", name))
    text = REFERENCE.sub(" ", text)
    for match in re.finditer(rf"\d[\d.,]*|{WORD.pattern}", text, re.I):
        found.append(" ".join(text[max(0, match.start() - 30) : match.end() + 20].split()))
    return found


def typed_numbers_in_code(code: str) -> list[str]:
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
    found = [number for code in FENCE.findall(source) for number in typed_numbers_in_code(code)]
    return found + typed_numbers_in_prose(FENCE.sub(" ", source))


def _in_formula(formula: str) -> list[str]:
    return re.findall(r"\d+\.\d+|\d{2,}", re.sub(r"\b10\^", "", formula))
