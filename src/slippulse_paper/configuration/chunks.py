"""Division of the runs of a sweep into chunks.

Each chunk gets one run a round, so that neighbours, which cost about the same, are apart. The first
chunk of a round is random: else one chunk could get all runs with one value of a list.
"""

import random
from collections.abc import Iterator


def runs_of(chunk: int, chunks: int, runs: int) -> Iterator[int]:
    """Yield the numbers of the runs, from 0, in a chunk of a sweep, numbered from 1."""
    for turn, start in enumerate(range(0, runs, chunks)):
        # Python promises that `random` draws the same numbers in every version, and no more.
        first = int(chunks * random.Random(turn).random())
        run = start + (chunk - 1 - first) % chunks
        if run < runs:
            yield run
