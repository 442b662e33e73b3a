"""Whether results are what they were, and whether two trees of results agree within their uncertainties.

python -m slippulse.verify results                         against results/checksums.txt
python -m slippulse.verify results --against other/results
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from .records import file_digest

# What makes a run the same run in another tree, whatever its lattice.
SAME = ("boundary", "left", "right", "width", "gamma", "damping_ratio", "duration", "release")
# Numbers that agree to this need no uncertainty: tables have nine digits.
DIGITS = 1e-8
SHOWN = 10


def changed_files(results: str | Path) -> list[str]:
    """One line for each file that is missing or no longer what checksums.txt says.

    Raises
    ------
    ValueError
        Without a readable checksums.txt.
    """
    results = Path(results)
    listing = results / "checksums.txt"
    try:
        lines = listing.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ValueError(f"{listing}: {reason}; allowed: a finished tree of results") from None
    problems = []
    for number, line in enumerate(lines, start=1):
        match = re.fullmatch(r"([0-9a-f]{64})  (\S.*)", line)
        if not match or ".." in Path(match[2]).parts or Path(match[2]).is_absolute():
            problems.append(f"{listing}: line {number} is not a checksum and a path inside the results")
            continue
        try:
            if file_digest(results / match[2]) != match[1]:
                problems.append(f"{results / match[2]}: not what it was")
        except OSError as error:
            problems.append(f"{results / match[2]}: {error.strerror}")
    return problems


@dataclass(frozen=True)
class Comparison:
    """Numbers of two trees of results.

    Attributes
    ----------
    compared, agree : how many numbers both have, and how many differ by no more than both uncertainties together
    unknown : how many differ, and have no uncertainty on either side
    apart : one line for each number that differs by more
    verdicts : one line for each claim with another verdict
    only : simulations that one of them lacks, or has with other runs
    """

    compared: int
    agree: int
    unknown: int
    apart: tuple[str, ...]
    verdicts: tuple[str, ...]
    only: tuple[str, ...]


def compare(here: str | Path, there: str | Path) -> Comparison:
    """Compare the measured numbers and verdicts of two trees.

    Raises
    ------
    ValueError
        If one has no uncertainties to compare by.
    """
    here, there = Path(here), Path(there)
    names = {}
    for tree in (here, there):
        names[tree] = {path.name for path in (tree / "uncertainties").glob("*.csv")}
        if not names[tree]:
            raise ValueError(f"{tree}/uncertainties: no tables; allowed: a finished tree of results")
    compared = agree = unknown = 0
    apart, only = [], [f"{name}: in one tree only" for name in sorted(names[here] ^ names[there])]
    for name in sorted(names[here] & names[there]):
        one, two = (pd.read_csv(tree / "uncertainties" / name) for tree in (here, there))
        runs = [
            table.drop_duplicates("point")[["point", *SAME]].reset_index(drop=True) for table in (one, two)
        ]
        if not runs[0].equals(runs[1]):
            only.append(f"{name}: other runs")
            continue
        both = one.merge(two, on=["point", "quantity"], suffixes=("", "_there"))
        both = both[np.isfinite(both["value"]) & np.isfinite(both["value_there"])]
        difference = (both["value"] - both["value_there"]).abs()
        allowed = both["uncertainty"].fillna(0.0) + both["uncertainty_there"].fillna(0.0)
        rounding = DIGITS * both["value"].abs()
        within = difference <= allowed + rounding
        uncertain = ~within & both["uncertainty"].isna() & both["uncertainty_there"].isna()
        compared, agree, unknown = (
            compared + len(both),
            agree + int(within.sum()),
            unknown + int(uncertain.sum()),
        )
        for index in np.flatnonzero(~within & ~uncertain):
            row = both.iloc[index]
            apart.append(
                f"{name}: point {row['point']}, {row['quantity']}: {row['value']:.6g} against"
                f" {row['value_there']:.6g}; allowed: a difference of {allowed.iloc[index]:.2g}"
            )
    return Comparison(compared, agree, unknown, tuple(apart), tuple(_verdicts(here, there)), tuple(only))


def _verdicts(here: Path, there: Path) -> list[str]:
    found = []
    for tree in (here, there):
        path = tree / "claims.json"
        if not path.exists():
            return [f"{path}: missing; verdicts not compared"]
        found.append(
            {claim["id"]: claim["verdict"] for claim in json.loads(path.read_text(encoding="utf-8"))}
        )
    one, two = found
    return [
        f"{name}: {one.get(name, 'no such claim')!r} against {two.get(name, 'no such claim')!r}"
        for name in sorted({*one, *two})
        if one.get(name) != two.get(name)
    ]


def main(arguments: Sequence[str]) -> int:
    """Verify or compare; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m slippulse.verify", description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path)
    parser.add_argument("--against", type=Path, help="another tree of results, to compare numbers with")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.against is None:
            problems = changed_files(chosen.results)
            count = len((chosen.results / "checksums.txt").read_text(encoding="utf-8").splitlines())
            print("\n".join(problems) or f"{count} files are what they were")
            return 1 if problems or not count else 0
        result = compare(chosen.results, chosen.against)
    except ValueError as error:
        print(error)
        return 1
    print(
        f"{result.agree} of {result.compared} numbers agree within both uncertainties together;"
        f" {result.unknown} differ and have no uncertainty"
    )
    for title, lines in (
        ("Apart", result.apart),
        ("Other verdicts", result.verdicts),
        ("Not compared", result.only),
    ):
        if lines:
            rest = [f"... and {len(lines) - SHOWN} more"] if len(lines) > SHOWN else []
            print("\n  ".join([f"{title}:", *lines[:SHOWN], *rest]))
    return 0 if result.compared and not (result.apart or result.verdicts or result.only) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
