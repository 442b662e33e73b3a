"""Division of the runs of a sweep into chunks.

The runs are dealt out in rounds, like cards: each chunk gets one run in each round. Neighbouring
runs take about the same time. Since they are in different chunks, all chunks take about the same
time. Each round begins with a random chunk, because otherwise one chunk could get all runs with one
value of a list.
"""

import random
from collections.abc import Iterator


def runs_of(chunk: int, chunk_count: int, run_count: int) -> Iterator[int]:
    """Yield the numbers of the runs in one chunk of a sweep.

    In each round every chunk gets one run, and a random chunk gets the first one. Chunks are
    numbered from 1, and runs from 0.
    """
    for round_number, first_run in enumerate(range(0, run_count, chunk_count)):
        # Every version of Python gives the same random numbers for the same seed.
        first_chunk = 1 + int(chunk_count * random.Random(round_number).random())
        # The chunks get their runs in turn, and chunk 1 follows the last chunk.
        turn_of_chunk = (chunk - first_chunk) % chunk_count
        run = first_run + turn_of_chunk
        # The last round may be incomplete.
        if run < run_count:
            yield run
