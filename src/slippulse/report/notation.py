"""From the plain formulas of the ledger, such as pi/sqrt(gamma), to TeX."""

from __future__ import annotations

import re

from .numerals import scientific

GREEK = ("gamma", "Gamma", "tau", "beta", "lambda", "rho", "mu", "sigma", "delta", "pi")
# Words that make a run of text a formula; single letters and numbers only come along.
STRONG = re.compile(
    rf"^({'|'.join(GREEK)})(_\w+)?$|^sqrt$|^[TL]_trans$|^x_(minus|plus)$|^[vGH]_\w+$|^dx$|^W_\w+$"
)
TOKEN = re.compile(
    r"\s+|->|[A-Za-z]+(?:_(?:[A-Za-z]+|\d+))?|\d+(?:\.\d+)?(?:e[-+]?\d+)?|[-+*/^=<>()|,;:.]|.", re.S
)
WEAK = re.compile(r"^(\d+(\.\d+)?(e[-+]?\d+)?|[A-Zb-hj-z]|[-+*/^=<>()|]|->)$")


def tex(statement: str) -> str:
    """A statement of the ledger as Markdown with its formulas as TeX.

    Parameters
    ----------
    statement : plain text with formulas in the notation of the source code
    """
    tokens = TOKEN.findall(statement)
    kinds = [_kind(token) for token in tokens]
    out, i = [], 0
    while i < len(tokens):
        end = i
        while end < len(tokens) and kinds[end] != "text" and not (end > i and _remark(tokens, end)):
            end += 1
        run = tokens[i:end]
        first, last = _trim(run)
        middle = run[first:last]
        if _is_formula(middle):
            out += [*map(_plain, run[:first]), "$" + _convert(middle) + "$", *map(_plain, run[last:])]
            i = end
        else:
            out.append(_plain(tokens[i]))
            i += 1
    return scientific("".join(out))


def _kind(token: str) -> str:
    if token.isspace():
        return "space"
    if STRONG.match(token):
        return "strong"
    return "weak" if WEAK.match(token) else "text"


def _remark(tokens: list[str], start: int) -> bool:
    """Whether a bracket with an equation opens here, such as (beta = 0): a remark, not a factor."""
    return tokens[start] == "(" and "=" in tokens[start : _closing(tokens, start)]


def _is_formula(run: list[str]) -> bool:
    strong = any(STRONG.match(token) for token in run)
    equation = len(run) > 2 and "=" in run and run[0] != "="
    return bool(run) and (strong or equation)


def _trim(run: list[str]) -> tuple[int, int]:
    """Leave out spaces and brackets at the ends that have no partner inside."""
    first, last = 0, len(run)
    changed = True
    while changed and first < last:
        changed = False
        middle = run[first:last]
        unbalanced = middle.count("(") - middle.count(")")
        if run[first].isspace() or run[first] == ")" or (run[first] == "(" and unbalanced > 0):
            first, changed = first + 1, True
        elif run[last - 1].isspace() or run[last - 1] == "(" or (run[last - 1] == ")" and unbalanced < 0):
            last, changed = last - 1, True
    return first, last


def _convert(tokens: list[str]) -> str:
    out, i, bars = [], 0, 0
    while i < len(tokens):
        token = tokens[i]
        if token == "sqrt" and i + 1 < len(tokens) and tokens[i + 1] == "(":
            end = _closing(tokens, i + 1)
            out.append(r"\sqrt{" + _convert(tokens[i + 2 : end]) + "}")
            i = end + 1
            continue
        if token == "|":
            out.append(r"\left|" if bars % 2 == 0 else r"\right|")
            bars += 1
        else:
            out.append(_symbol(token))
        i += 1
    return "".join(out).strip()


def _closing(tokens: list[str], start: int) -> int:
    depth = 0
    for i in range(start, len(tokens)):
        depth += (tokens[i] == "(") - (tokens[i] == ")")
        if depth == 0:
            return i
    return len(tokens)


def _symbol(token: str) -> str:
    if token.isspace():
        return " "
    if re.match(r"\d.*e", token):
        return scientific(token).strip("$")
    if token == "->":
        return r"\to "
    if token == "dx":
        return r"\Delta x"
    if token == "x_minus":
        return "x_-"
    base, _, index = token.partition("_")
    if base in GREEK:
        base = "\\" + base + " "
    if not index:
        return base
    return base.strip() + "_{" + (rf"\mathrm{{{index}}}" if index.isalpha() else index) + "}"


def _plain(token: str) -> str:
    """Text that Markdown and its tables leave alone."""
    return re.sub(r"([|*$<>\[\]])", r"\\\1", token)
