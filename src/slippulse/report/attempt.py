"""Theory where it has an answer: a scene outside its domain leaves the report standing."""

from __future__ import annotations

from collections.abc import Callable

NAN = float("nan")


class Absent(float):
    """A number that is not there, nor any part of it."""

    def __new__(cls) -> Absent:
        return super().__new__(cls, NAN)

    def __getattr__(self, name: str) -> Absent:
        if name.startswith("_"):
            raise AttributeError(name)
        return Absent()

    def __getitem__(self, index: object) -> Absent:
        return Absent()

    def __call__(self, *arguments: object) -> Absent:
        return Absent()

    def __neg__(self) -> Absent:
        return Absent()


def attempt(function: Callable, *arguments: object):
    """``function(*arguments)``, or `Absent` where the theory says that it has no answer."""
    try:
        return function(*arguments)
    except (ValueError, ArithmeticError):
        return Absent()
