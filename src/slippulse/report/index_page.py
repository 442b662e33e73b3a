"""results/index.html, the page to open. Relative links only; nothing is loaded from outside."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import yaml
from markupsafe import Markup

from ..claims.reading import FAILURES_FIRST, Ledger
from ..configuration.parameters import parameters
from ..data.prose import fill
from .captions import read_captions
from .claims_page import SIGNS, claim_groups
from .html import markup_of, page, picture_size

FILES = {
    "explorer.html": "Explorer (a rupture with sliders)",
    "manuscript/replication.html": "Replication report (HTML)",
    "manuscript/replication.pdf": "Replication report (PDF)",
    "claims.html": "Ledger of claims (a table)",
    "claims.json": "Ledger of claims (JSON)",
    "findings.json": "Findings beside them (JSON)",
    "provenance.json": "Provenance (JSON)",
    "codecheck.yml": "Manifest of every output (CODECHECK)",
    "checksums.txt": "Checksums (make verify)",
    "scenes/index.html": "Scenes",
}


@dataclass(frozen=True)
class Figure:
    """A figure as it is shown: name, heading, alternative text, finding and caption as HTML, width and height."""

    name: str
    title: str
    alt: str
    finding: Markup
    caption: Markup
    size: tuple[int, int] | None


@dataclass(frozen=True)
class Line:
    """One line of the verdict: its topic, the claim that decides it, verdict and sign, and what was found as HTML."""

    topic: str
    claim: str
    verdict: str
    sign: str
    text: Markup


def index_page(
    results: str | Path,
    texts: Mapping[str, str | Path],
    galleries: Mapping[str, Sequence[str]],
    scenes: Mapping[str, str],
) -> str:
    """The page.

    Parameters
    ----------
    results : folder that the page stands in, with claims.json, findings.json and provenance.json; files that are not
        there get no link
    texts : files of the `captions` and of the `summary`
    galleries : names of figures by the heading that they stand under
    scenes : titles by name
    """
    results = Path(results)
    ledger = Ledger(
        *(
            json.loads((results / name).read_text(encoding="utf-8"))
            for name in ("claims.json", "findings.json")
        )
    )
    facts = json.loads((results / "provenance.json").read_text(encoding="utf-8"))
    names = {"claim": ledger, "found": ledger.found, "config": facts["config"], "facts": facts}
    names["runs"] = partial(parameters, facts["config"])
    captions = read_captions(texts["captions"], lambda text: fill(text, names))
    summary = yaml.safe_load(Path(texts["summary"]).read_text(encoding="utf-8"))
    accuracy = fill(summary["accuracy"], names)
    lines = [line | {"text": fill(line["text"], names)} for line in summary["verdict"]]

    shown = {
        # A sweep of one's own has no caption but its name.
        name: captions.get(name) or replace(captions["own_sweep"], title=name.removeprefix("sweep_"))
        for listed in galleries.values()
        for name in listed
    }
    html = markup_of(
        [text for entry in shown.values() for text in (entry.finding, entry.caption)]
        + [line["text"] for line in lines]
        + [accuracy]
    )
    figures = {
        name: Figure(
            name,
            entry.title,
            entry.alt,
            html[entry.finding],
            html[entry.caption],
            picture_size(results / f"figures/{name}.png"),
        )
        for name, entry in shown.items()
    }
    return page(
        "index.html",
        paper=facts["paper"],
        altered=facts["overlay"],
        lines=[_line(line, ledger, html[line["text"]]) for line in lines],
        accuracy=html[accuracy],
        picture=figures.get(summary["picture"]),
        files={path: title for path, title in FILES.items() if (results / path).exists()},
        summary=ledger.summary(),
        kinds=ledger.by_kind(),
        verdicts=FAILURES_FIRST,
        groups=claim_groups(ledger),
        galleries={title: [figures[name] for name in listed] for title, listed in galleries.items()},
        scenes={name: (title, (results / f"scenes/{name}.html").exists()) for name, title in scenes.items()},
        facts=_facts(facts),
    )


def _line(line: Mapping, ledger: Ledger, text: Markup) -> Line:
    """A line has the worst verdict of its claims."""
    worst = min(map(ledger, line["claims"]), key=lambda claim: FAILURES_FIRST.index(claim.verdict))
    return Line(line["topic"], worst.id, worst.verdict, SIGNS[worst.verdict], text)


def _facts(facts: Mapping) -> dict[str, str]:
    """What the results were made from, in words."""
    git, machine = facts["git"], facts["machine"]
    state = "not a git repository"
    if git:
        count = len(git["changed_files"])
        state = f"commit {git['commit']}" + (f", {count} files changed" if count else "")
    parts = [
        f"{machine['system']} {machine['architecture']}",
        machine["processor"],
        f"{machine['cores']} cores",
    ]
    if machine["memory_GiB"]:
        parts.append(f"{machine['memory_GiB']} GiB of memory")
    return {
        "preset": str(facts["config"]["preset"]),
        "sources": state,
        "digest of the sources": facts["source_digest"],
        "digest of the lock": facts["lock_digest"],
        "versions": ", ".join(f"{name} {version}" for name, version in facts["versions"].items()),
        "machine": ", ".join(part for part in parts if part),
        "computing time": f"{sum(facts['times']['seconds_of_jobs'].values()):.0f} s of jobs",
        "written": facts["times"]["written"],
    }
