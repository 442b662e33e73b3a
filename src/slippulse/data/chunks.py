"""Division of the runs of a sweep into chunks: a rule that needs only the number of chunks.

Each chunk gets one run a round: neighbours, which cost about the same, go to different chunks. The
first chunk changes at random from round to round, always in the same way: else a list of as many
values as there are chunks would give each chunk one value of it.
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
