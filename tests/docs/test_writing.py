"""The check of the language finds the mistakes that docs/writing.md names, and no others."""

import subprocess

import pytest

from docs.check_writing import FRAGMENT_WORDS, file_problems, main

FUNCTION = 'def f():\n    """{}"""\n    return {}\n'


def problems(name: str, text: str) -> list[tuple[int, str]]:
    return [*file_problems(name, text)]


@pytest.mark.parametrize("word", FRAGMENT_WORDS)
def test_a_docstring_that_begins_a_fragment_is_refused(word):
    expected = f"a docstring begins with {word}"
    assert problems("tests/a.py", FUNCTION.format(f"{word} it is.", 1)) == [(2, expected)]
    assert problems("src/a.py", f'class A:\n    """{word}\n    it is.\n    """\n') == [
        (2, expected)
    ]
    assert problems("src/a.py", f'"""{word}: it is."""\n') == [(1, expected)]
    assert problems("workflow/a.smk", f'x\n\ndef f():\n    """{word} it is."""\n') == [
        (4, expected)
    ]


@pytest.mark.parametrize("text", ["Offsets.", "Bytes.", "Return what it is.", "Thatched.", "HOW"])
def test_other_docstrings_are_allowed(text):
    assert problems("src/a.py", FUNCTION.format(text, 1)) == []


def test_other_texts_in_quotes_may_begin_with_any_word():
    assert problems("src/a.py", 'x = """What it is."""\n') == []
    assert problems("docs/a.md", "What it is.\n") == []


@pytest.mark.parametrize("name", ["a.py", "a.md", "a.yaml", "a.smk"])
def test_a_replaced_word_is_refused_in_every_text(name):
    assert problems(name, "# It\n# is made anew.\n") == [(2, "the word anew")]
    assert problems(name, "# A new one.\n# ManEwe anewer\n") == []


def test_a_returned_tuple_of_three_or_more_values_is_refused_in_the_packages():
    expected = "3 values returned as a tuple; allowed: a NamedTuple or a dataclass"
    assert problems("src/a.py", FUNCTION.format("Return.", "1, 2, 3")) == [(3, expected)]
    assert problems("src/a.py", FUNCTION.format("Return.", "(1, 2, 3)")) == [(3, expected)]
    assert problems("tests/a.py", FUNCTION.format("Return.", "1, 2, 3")) == []
    for value in ("1, 2", "[1, 2, 3]", "Position(1, 2, 3)", "(1, 2, 3)[0]"):
        assert problems("src/a.py", FUNCTION.format("Return.", value)) == []


def test_a_project_is_checked_in_its_tracked_files(tmp_path, capsys):
    (tmp_path / "good.md").write_text("It is made again.\n", encoding="utf-8")
    (tmp_path / "bad.md").write_text("It is made anew.\n", encoding="utf-8")
    subprocess.run(["git", "init", "--quiet"], cwd=tmp_path, check=True)
    subprocess.run(["git", "add", "good.md"], cwd=tmp_path, check=True)
    assert main(tmp_path) == 0 and capsys.readouterr().out == ""
    subprocess.run(["git", "add", "bad.md"], cwd=tmp_path, check=True)
    assert main(tmp_path) == 1
    assert capsys.readouterr().out.startswith("bad.md:1: the word anew\n")
