"""Division of the runs of a sweep into chunks.

The runs are dealt out in rounds, like cards: each chunk gets one run in each round. Neighbouring
runs cost about the same. Since they are in different chunks, all chunks cost about the same. Each
round begins with a random chunk, because otherwise one chunk could get all runs with one value of a
list.
"""

import random
from collections.abc import Iterator


def runs_of(chunk: int, chunks: int, runs: int) -> Iterator[int]:
    """Yield the numbers of the runs in one chunk of a sweep.

    ``chunks`` and ``runs`` are the numbers of all chunks and runs of the sweep. Chunks are numbered
    from 1, and runs from 0.
    """
    for dealing_round, first_run in enumerate(range(0, runs, chunks)):
        # Python guarantees that this method gives the same numbers in every version.
        first_chunk = 1 + int(chunks * random.Random(dealing_round).random())
        run = first_run + (chunk - first_chunk) % chunks
        if run < runs:
            yield run
