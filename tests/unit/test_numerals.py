"""Numbers as texts, pages and figures write them."""

import math

import pytest

from slippulse_paper.report.html import markup_of
from slippulse_paper.text.numerals import number, percent, rounded, setting, short, with_uncertainty
from slippulse_paper.text.prose import fill, without_missing

NOT = "not measured"
# A value, its uncertainty, and how both are written.
UNCERTAIN = [
    (1.9169812, 3.3e-6, "1.91698(1)"),
    (1.47554, 0.01267, "1.476(13)"),
    (0.0867, 0.00984, "0.087(10)"),
    (116.57648, 0.05685, "116.58(6)"),
    (-0.0087971, 0.0010633, "−0.0088(11)"),
    (1.0, 0.5, "1.0(5)"),
    (-6.0e-17, 1.6e-16, "−0.6(1.6)×10⁻¹⁶"),
    (123456789.0, 1.0, "1.23457(1)×10⁸"),
    (1.0, 0.0, "1"),
    (0.123456789, 0.0, "0.12346"),
    (0.123456789, math.nan, "0.12346"),
    (None, None, NOT),
]
WRITTEN = [
    (number, {0.0: "0", 2: "2", -0.5: "−0.500", 1e-7: "1.00×10⁻⁷", math.inf: "∞"}),
    (number, {math.nan: NOT, None: NOT}),
    (lambda value: number(value, 9), {math.pi: "3.1416"}),
    # Digits are counted in what is written: 0.9996 with three digits is 1.00.
    (number, {0.9996: "1.00", 0.9994: "0.999", 9.996: "10.0", 0.09996: "0.100"}),
    (percent, {0.95: "95 %", 0.0712: "7.1 %", 1e-8: "10⁻⁸", None: NOT}),
    (setting, {0.01: "0.01", -0.3: "−0.3", 1e-9: "10⁻⁹", 12: "12"}),
    (rounded, {0.1: "0.1", 1.23456: "1.235", None: NOT}),
    (lambda value: short(value, 10), {(1,) * 99: "(1, 1, ...", None: "–"}),
]


@pytest.mark.parametrize(("value", "uncertainty", "text"), UNCERTAIN)
def test_an_uncertainty_stands_in_the_last_digits(value, uncertainty, text):
    assert with_uncertainty(value, uncertainty) == text


@pytest.mark.parametrize(("write", "texts"), WRITTEN)
def test_numbers_as_they_are_written(write, texts):
    assert {value: write(value) for value in texts} == texts


def test_prose_says_what_is_missing_and_refuses_what_is_unknown():
    names = {"pulse": None, "speed": 1.25, "estimate": None}
    text = "{{ pulse.width | number(4) }}, {{ estimate[0] | percent }}, {{ speed }} of $\\frac12$"
    assert fill(text, names) == "not measured, not measured, 1.25 of $\\frac12$"
    with pytest.raises(ValueError, match=r"^It is \{\{ speeed \}\}\.: UndefinedError: 'speeed'"):
        fill("First.\nIt is {{ speeed }}.", names)


def test_texts_for_pages_are_one_paragraph_each_and_show_raw_html():
    html = markup_of(["a <b>x</b> & $\\tau_0$", "(a) two", ""])
    assert html["a <b>x</b> & $\\tau_0$"].startswith("a &lt;b&gt;x&lt;/b&gt; &amp; <math")
    assert html["(a) two"] == "(a) two" and html[""] == ""
    with pytest.raises(ValueError, match="text for a page: '# a heading'; allowed: one paragraph"):
        markup_of(["# a heading"])
    with pytest.raises(ValueError, match="without a horizontal rule"):
        markup_of(["* * *", "words"])


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("It is 5. It was not measured. The end.", "It is 5. The end."),
        ("**Lead.** The speed $v$ is not measured.\n\nNext one.", "\n\nNext one."),
        ("**Lead.** It is not measured times 2. So\nit is.", "**Lead.** So\nit is."),
        ("- One is not measured.\n- Two. It is not measured.\n- Three.", "- Two.\n- Three."),
        ("| a | not measured |\n\nIs it not measured? No.", "| a | not measured |\n\nNo."),
    ],
)
def test_a_sentence_with_a_missing_number_is_left_out(text, shown):
    assert without_missing(text) == shown
