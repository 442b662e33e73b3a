"""No number is typed into the report."""

from __future__ import annotations

import pytest
import yaml
from report.numbers_rule import typed_numbers, typed_numbers_in_prose


def test_the_report_has_no_typed_number(manuscript):
    assert typed_numbers((manuscript / "replication.md").read_text(encoding="utf-8")) == []


def test_the_errata_the_captions_and_the_summary_have_none(manuscript):
    texts = [
        text
        for entry in yaml.safe_load((manuscript / "errata.yaml").read_text(encoding="utf-8"))
        for text in entry.values()
    ]
    captions = yaml.safe_load((manuscript / "captions.yaml").read_text(encoding="utf-8"))
    texts += [text for parts in captions.values() for text in parts.values()]
    summary = yaml.safe_load((manuscript / "summary.yaml").read_text(encoding="utf-8"))
    texts += [summary["accuracy"], *(line[key] for line in summary["verdict"] for key in ("topic", "text"))]
    assert [number for text in texts for number in typed_numbers_in_prose(text)] == []


@pytest.mark.parametrize(
    "text",
    [
        "The front runs at 1.25 wave speeds.",
        "We made 81 runs.",
        "It deviates by 7 %.",
        "It takes eleven figures.",
        "It is off by ten per cent.",
        "The speed is $v = 1.25$.",
        "After $T = 39$ it stops.",
        "It is `1.25` exactly.",
        "The speed is {{ 1.25 | number }}.",
        "The speed is {{ (claim.measured('x') + 12) | number }}.",
        "```python\nshow('the speed is 5')\n```\n",
        "```python\nspeed = 1.25\n```\n",
        "```python\nshow(f'{speed} is 5 more')\n```\n",
        "In 2021 it was found.",
    ],
)
def test_a_typed_number_is_found(text):
    assert typed_numbers(text)


@pytest.mark.parametrize(
    "text",
    [
        r"By equations (B9), (B11) and (5) the damping $\beta=10^{-3}$ is $1/\sqrt{1-\tau_0^2}$.",
        "Known [@Amundsen2015] from figure 4 and section 3.",
        "The claim `published_trailing_edge_5` is {{ claim('a_1').measured | number(3) }}.",
        "```python\nfigure('fig05_scaling')\nx = 2 * y\n```\n",
    ],
)
def test_formulas_references_and_expressions_are_not(text):
    assert typed_numbers(text) == []
