"""Whether two trees of results agree within their uncertainties.

python -m slippulse.report.compare results other/results
"""

import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from ..data.alterations import changes
from ..data.files import UnreadableFile
from ..data.tables import load_table

# What makes a run the same run in another tree, whatever its lattice.
SAME = ["boundary", "left", "right", "width", "gamma", "damping_ratio", "duration", "release"]
TEXTS = ("boundary", "release", "quantity")
# What a number without uncertainty depends on besides.
LATTICE = ["scheme", "dx", "order", "max_step"]
# Numbers that agree to this need no uncertainty: tables have nine digits. On one lattice those without agree to so much
# of themselves, or of 1.
DIGITS, ROUNDING = 1e-8, 1e-6
SHOWN = 10


@dataclass
class Comparison:
    """How many numbers there are, agree, and are unknown; lines on those apart, and on what is not comparable."""

    compared: int = 0
    agree: int = 0
    unknown: int = 0
    apart: list[str] = field(default_factory=list)
    other: list[str] = field(default_factory=list)


def compare(here: Path, there: Path) -> Comparison:
    """Compare measured tables, configurations and verdicts; ValueError for one without tables or a broken file."""
    found, trees = Comparison(), (here, there)
    names = [{path.name for path in (tree / "measurements").glob("*.csv")} for tree in trees]
    for tree, tables in zip(trees, names, strict=True):
        if not tables:
            raise ValueError(f"{tree}/measurements: no tables; allowed: a finished tree of results")
    found.other += [f"{name}: in one tree only" for name in sorted(names[0] ^ names[1])]
    # But for the preset, whose lattices the uncertainties cover.
    for name, what, line in (
        ("provenance.json", "configurations", "configuration: {key}: {here!r} against {shipped!r}"),
        ("claims.json", "verdicts", "{key}: verdict {here!r} against {shipped!r}"),
    ):
        contents = [_content(tree / name) for tree in trees if (tree / name).exists()]
        if len(contents) < 2:
            found.other.append(f"{name}: missing in one tree; {what} not compared")
        else:
            found.other += [line.format(**change) for change in changes(contents[1], contents[0])]
    for name in sorted(names[0] & names[1]):
        _compare_tables(found, trees, name)
    return found


def _compare_tables(found: Comparison, trees: tuple[Path, Path], name: str) -> None:
    """One table of measured numbers, with the grid studies of both."""
    one, two = (_table(tree / "measurements" / name, SAME) for tree in trees)
    if not one[SAME].equals(two[SAME]):
        found.other.append(f"{name}: other runs")
        return
    found.other += [
        f"{name}: columns in one tree only: {column}" for column in sorted({*one} ^ {*two})
    ]
    studies = [tree / "uncertainties" / name for tree in trees]
    if len({path.exists() for path in studies}) > 1:
        found.other.append(f"{name}: uncertainties in one tree only")
    both = [column for column in one if column in two and column not in SAME]
    lattice = [column for column in both if column in LATTICE]
    alike = (one[lattice] == two[lattice]).all(axis=1).to_numpy()[:, None]
    texts = [column for column in both if "O" in (one[column].dtype.kind, two[column].dtype.kind)]
    numbers = [column for column in both if column not in texts + LATTICE]
    ours, theirs = (table[numbers].astype(float) for table in (one, two))
    bars = [*map(_uncertainties, studies, (ours, theirs))]
    bar = bars[0].add(bars[1], fill_value=0.0)
    allowed = bar.fillna(0.0) + DIGITS * ours.abs()
    allowed = allowed.mask(bar.isna() & alike, ROUNDING * ours.abs().clip(lower=1.0))
    counted = (ours.notna() & theirs.notna()) | ((ours.notna() | theirs.notna()) & alike)
    off = counted & ~((ours - theirs).abs() <= allowed)
    unknown = off & bar.isna() & ~alike
    compared, differ, unsure = (int(cells.to_numpy().sum()) for cells in (counted, off, unknown))
    found.compared, found.agree = found.compared + compared, found.agree + compared - differ
    found.unknown += unsure
    for point, quantity in np.argwhere((off & ~unknown).to_numpy()):
        values = f"{ours.iat[point, quantity]:.6g} against {theirs.iat[point, quantity]:.6g}"
        most = f"allowed: a difference of {allowed.iat[point, quantity]:.2g}"
        found.apart.append(f"{name}: point {point}, {numbers[quantity]}: {values}; {most}")
    ours, theirs = (table[texts].astype(object).fillna("") for table in (one, two))
    for point, text in np.argwhere(((ours != theirs) & alike).to_numpy()):
        values = f"{ours.iat[point, text]!r} against {theirs.iat[point, text]!r}"
        found.apart.append(f"{name}: point {point}, {texts[text]}: {values}")


def _table(path: Path, needed: Iterable[str]) -> pd.DataFrame:
    """A table with these columns, and with no text in a column of numbers."""
    with _readable(path):
        table = load_table(path)
        for column in needed:
            if column not in table:
                raise ValueError(f"no column {column}")
            if table[column].dtype.kind not in "biuf" and column not in TEXTS:
                raise ValueError(f"text in column {column}")
    return table


def _uncertainties(path: Path, values: pd.DataFrame) -> pd.DataFrame:
    """Uncertainty of every number; NaN where it is not known, as where the study was of another value."""
    if not path.exists():
        return values * np.nan
    table = _table(path, ["point", "quantity", "value", "uncertainty"])
    with _readable(path):
        study = table.pivot(
            index="point", columns="quantity", values=["value", "uncertainty"]
        ).astype(float)
        studied, found = (study[part].reindex_like(values) for part in ("value", "uncertainty"))
    return found.mask((values - studied).abs() > DIGITS * values.abs())


def _content(path: Path) -> dict:
    """The configuration but for the preset, or the verdicts by claim."""
    with _readable(path):
        content = json.loads(path.read_text(encoding="utf-8"))
        if path.stem == "provenance":
            return dict(content["config"]) | {"preset": None}
        return {str(claim["id"]): claim["verdict"] for claim in content}


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Name the file that cannot be read, or does not hold what a run writes."""
    try:
        yield
    except UnreadableFile:
        raise
    except LookupError as error:
        raise UnreadableFile(path, f"no {error}") from None
    except (OSError, ValueError, TypeError, RecursionError) as error:
        raise UnreadableFile(path, getattr(error, "strerror", None) or error) from None


def main(arguments: Sequence[str]) -> int:
    """Compare two trees; returns the exit code."""
    try:
        result = compare(*map(Path, arguments))
    except ValueError as error:
        print(error)
        return 1
    agree = f"{result.agree} of {result.compared} numbers agree within both uncertainties together"
    print(f"{agree}; {result.unknown} differ and have no uncertainty")
    for title, lines in (("Apart", result.apart), ("Not comparable", result.other)):
        if lines:
            rest = [f"... and {len(lines) - SHOWN} more"] if len(lines) > SHOWN else []
            print("\n  ".join([f"{title}:", *lines[:SHOWN], *rest]))
    return 0 if result.compared and not (result.apart or result.other) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
