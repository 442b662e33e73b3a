"""results/claims.html: the ledger by kind and failures first, each deviation next to its tolerance."""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from types import SimpleNamespace

from ..claims import reading
from ..claims.reading import Ledger
from ..claims.rules import VERDICTS, WORST_FIRST
from ..data.numerals import rounded
from .html import markup_of, page

# Each verdict has a sign, so that colour is not needed.
MARKS = "\N{CHECK MARK}~\N{UP DOWN ARROW}\N{MULTIPLICATION SIGN}?\N{EN DASH}"
SIGNS = dict(zip(VERDICTS, MARKS, strict=True))
# The bar of a deviation ends at this many tolerances.
LONGEST = 2.0
# Folders of tables whose kind has another name.
KINDS = {"measurements": "measured", "predictions": "predicted", "studies": "study"}
Rows = Sequence[Mapping]
# Of more simulations than these everything is made.
FEW = 6


def claims_page(
    claims: Rows, altered: Rows = (), findings: Rows = (), tables: Iterable[str] = ()
) -> str:
    """The ledger and the findings, as in their JSON, with links to tables, files from the folder of the page on."""
    return page(
        "claims.html",
        findings=findings,
        altered=altered,
        tables_behind=partial(tables_behind, tables=sorted(tables)),
        command=command,
        counted=lambda claims: sum(claim.counted for claim in claims),
        rules_altered=any(change["key"].startswith("claims.") for change in altered),
        **shown(Ledger(claims), [finding["text"] for finding in findings]),
    )


def shown(ledger: Ledger, texts: Iterable[str]) -> dict[str, object]:
    """What templates that show claims ask for; `html` has the HTML of each of their texts, and of others."""
    asked = [(claim.statement, claim.why, reading.evidence_text(claim)) for claim in ledger]
    by_verdict = {
        name: [claim for claim in ledger if claim.verdict == name] for name in WORST_FIRST
    }
    return {
        "html": markup_of([*texts, *chain.from_iterable(asked)]),
        "summary": ledger.summary(),
        "groups": {verdict: claims for verdict, claims in by_verdict.items() if claims},
        "signs": SIGNS,
        "reading": reading,
        "bar": bar,
        "figure_title": figure_title,
    }


def tables_behind(source: str, tables: Sequence[str]) -> dict[str, dict[str, str]]:
    """Files of the simulations and studies that a source names, by name and kind of table."""
    found: dict[str, dict[str, str]] = {}
    for path in map(Path, tables):
        found.setdefault(path.stem, {})[KINDS.get(path.parts[0], path.parts[0])] = path.as_posix()
    if source.startswith("every simulation"):
        return found
    return {
        name: found[name] for name in dict.fromkeys(re.findall(r"\w+", source)) if name in found
    }


def command(behind: Mapping[str, Mapping[str, str]]) -> str:
    """The command that makes some tables anew."""
    if len(behind) > FEW:
        return "make replicate"
    paths = [f"results/{path}" for kinds in behind.values() for path in kinds.values()]
    return f'make replicate TARGET="{" ".join(paths)}"' if paths else "make test"


def bar(claim: SimpleNamespace) -> tuple[str, float] | None:
    """Deviation over tolerance in words, and the length of its bar in percent; None where the kind has no such bar."""
    if claim.kind not in ("exact", "approximate") or claim.deviation is None or not claim.tolerance:
        return None
    ratio = claim.deviation / claim.tolerance
    return f"{rounded(ratio, 2)} × tolerance", round(100.0 * min(ratio, LONGEST) / LONGEST, 1)


def figure_title(name: str) -> str:
    """What a link to a figure says: figure 5, scaling."""
    kind, _, words = name.replace("_", " ").partition(" ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}"
