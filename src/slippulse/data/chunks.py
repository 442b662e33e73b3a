"""Which runs of a sweep are in which of its chunks: a rule that needs the number of chunks and nothing else.

Each round of as many runs as there are chunks goes to as many different chunks: neighbours, which cost
about the same, are spread. Who is first changes from round to round at random, always in the same way; were it
always the same, a list of as many values as there are chunks would give each chunk a single value of it.
"""

import random
from collections.abc import Iterator


def runs_of(number: int, chunks: int, runs: int) -> Iterator[int]:
    """The runs of one chunk, from 0 and in the order of the sweep, by its number from 1 and how many there are."""
    for turn, start in enumerate(range(0, runs, chunks)):
        run = start + (number - 1 - _first(turn, chunks)) % chunks
        if run < runs:
            yield run


def _first(turn: int, chunks: int) -> int:
    # Of its draws Python promises this one to be the same in every version.
    return int(chunks * random.Random(turn).random())
