"""results/index.html: the one page to open. Relative links only; nothing is loaded from outside."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from ..claims.ledger import VERDICTS
from .layout import Html, link, page, table_html

# Shown in this order, each with a sign, so that colour is not needed.
SIGNS = dict(zip(VERDICTS, "\N{CHECK MARK}~\N{MULTIPLICATION SIGN}?", strict=True))
REPORTS = {
    "manuscript/replication.html": "Replication report (HTML)",
    "manuscript/replication.pdf": "Replication report (PDF)",
    "claims.html": "Ledger of claims (a table)",
    "claims.json": "Ledger of claims (JSON)",
    "provenance.json": "Provenance (JSON)",
    "codecheck.yml": "Manifest of every output (CODECHECK)",
    "checksums.txt": "Checksums (make verify)",
    "scenes/index.html": "Scenes",
}


def index_page(
    results: str | Path,
    figures: Mapping[str, str],
    studies: Mapping[str, str],
    claims: Sequence[Mapping],
    facts: Mapping,
    scenes: Mapping[str, str],
) -> str:
    """The page.

    Parameters
    ----------
    results : folder that the page stands in; links to files that are not there are left out
    figures, studies : captions by name, the paper's figures and this project's studies
    claims : the ledger
    facts : provenance
    scenes : titles by name
    """
    results = Path(results)
    there = {path: text for path, text in REPORTS.items() if (results / path).exists()}
    sections = {
        "verdicts": ("Verdicts", _verdicts(claims)),
        "figures": ("Figures of the paper", _gallery(results, figures)),
        "studies": ("Studies beside the paper", _gallery(results, studies)),
        "scenes": ("Scenes", _scenes(results, scenes)),
        "provenance": ("Provenance", _provenance(facts)),
    }
    menu = "".join(f'<li><a href="#{key}">{escape(title)}</a></li>' for key, (title, _) in sections.items())
    files = "".join(f"<li>{link(path, text)}</li>" for path, text in there.items())
    body = "\n".join(
        f'<section aria-labelledby="{key}">\n<h2 id="{key}">{escape(title)}</h2>\n{content}\n</section>'
        for key, (title, content) in sections.items()
        if content
    )
    return page(
        "slippulse: results",
        "<header>\n<h1>The onset of slip pulses in frictional rupture: a replication</h1>\n"
        f'<nav aria-label="On this page"><ul>{menu}</ul></nav>\n'
        f'<nav aria-label="Files"><ul>{files}</ul></nav>\n</header>\n<main id="content">\n{body}\n</main>',
    )


def _verdicts(claims: Sequence[Mapping]) -> str:
    return (
        f"{_summary(claims)}\n"
        f"<details>\n<summary>All claims, one by one</summary>\n{_claims_table(claims)}\n</details>"
    )


def _summary(claims: Sequence[Mapping]) -> str:
    counts = Counter(claim["verdict"] for claim in claims)
    summary = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
    return f"<p>{len(claims)} claims: {escape(summary)}.</p>"


def _claims_table(claims: Sequence[Mapping]) -> str:
    ordered = sorted(claims, key=lambda claim: VERDICTS.index(claim["verdict"]))
    rows = [
        (
            f"{SIGNS[claim['verdict']]} {claim['verdict']}",
            claim["statement"],
            claim["figure_or_section"],
            _number(claim["predicted"]),
            _number(claim["measured"]),
            _number(claim["uncertainty"], ".1g"),
        )
        for claim in ordered
    ]
    return table_html(
        "Every claim, with what was predicted and measured",
        ("verdict", "what the paper says", "where", "predicted", "measured", "uncertainty"),
        rows,
        numeric=(3, 4, 5),
    )


def _number(value: float | None, form: str = ".5g") -> str:
    return "\N{EN DASH}" if value is None else f"{value:{form}}"


def _gallery(results: Path, captions: Mapping[str, str]) -> str:
    cards = []
    for name, caption in captions.items():
        # As an alternative text, the caption up to its first full stop; below the figure, all of it.
        alt = caption.split(". ")[0].rstrip(".")
        files = ", ".join(
            link(f"figures/{name}.{ending}", ending.upper()) for ending in ("png", "pdf", "csv")
        )
        cards.append(
            f'<figure id="{escape(name)}">\n<a href="figures/{escape(name)}.png">'
            f'<img src="figures/{escape(name)}.png" alt="{escape(alt)}" loading="lazy"{_size(results, name)}></a>\n'
            f"<figcaption><strong>{escape(name)}</strong> ({files}). {escape(caption)}</figcaption>\n</figure>"
        )
    return f'<div class="grid">\n{"".join(cards)}\n</div>' if cards else ""


def _size(results: Path, name: str) -> str:
    """Width and height of a PNG, so that the page does not jump while it loads."""
    path = results / f"figures/{name}.png"
    if not path.exists():
        return ""
    header = path.read_bytes()[16:24]
    width, height = int.from_bytes(header[:4], "big"), int.from_bytes(header[4:], "big")
    return f' width="{width}" height="{height}"'


def _scenes(results: Path, scenes: Mapping[str, str]) -> str:
    rows = []
    for name, title in scenes.items():
        made = (results / f"scenes/{name}.html").exists()
        where = (
            link(f"scenes/{name}.html", "page")
            if made
            else Html(f"<code>snakemake --cores 2 results/scenes/{escape(name)}.html</code>")
        )
        rows.append((name, title, where))
    if not rows:
        return ""
    return table_html(
        "Single runs by name, from the configuration",
        ("scene", "what it shows", "page, or how to make it"),
        rows,
    )


def _provenance(facts: Mapping) -> str:
    overlay = facts["overlay"]
    git = facts["git"]
    state = "not a git repository"
    if git:
        state = f"commit {git['commit']}" + (
            f", {len(git['changed_files'])} files changed" if git["changed_files"] else ""
        )
    rows = [
        (
            "configuration",
            "as shipped" if not overlay else f"{len(overlay)} values differ from the shipped ones, below",
        ),
        ("preset", str(facts["config"]["preset"])),
        ("sources", state),
        ("digest of the sources", facts["source_digest"]),
        ("digest of the lock", facts["lock_digest"]),
        ("versions", ", ".join(f"{name} {version}" for name, version in facts["versions"].items())),
        ("machine", ", ".join(str(value) for value in facts["machine"].values() if value)),
        ("computing time", f"{sum(facts['times']['seconds_of_jobs'].values()):.0f} s of jobs"),
        ("written", facts["times"]["written"]),
    ]
    parts = [table_html("What these results were made from", ("what", "value"), rows)]
    if overlay:
        changed = [(entry["key"], _short(entry["shipped"]), _short(entry["here"])) for entry in overlay]
        parts.append(
            table_html("What differs from the shipped configuration", ("key", "shipped", "here"), changed)
        )
    return "\n".join(parts)


def _short(value: object) -> str:
    text = "\N{EN DASH}" if value is None else str(value)
    return text if len(text) <= 160 else text[:157] + "..."


def captions_from(figures: Mapping[str, Mapping]) -> dict[str, str]:
    """Captions as plain text: one line each, without mark-up, with the settings that they quote.

    Parameters
    ----------
    figures : per figure its caption (a file of reStructuredText) and its settings

    Raises
    ------
    ValueError
        If a caption quotes something else than a setting of its figure.
    """
    out = {}
    for name, figure in figures.items():
        text = " ".join(Path(figure["caption"]).read_text(encoding="utf-8").split())

        def value(match: re.Match, settings: Mapping = figure["settings"]) -> str:
            found = settings
            for key in re.findall(r'\["(\w+)"\]', match[1]):
                found = found[key]
            return str(found)

        text = re.sub(r'\{\{ *snakemake\.params\.settings((?:\["\w+"\])+) *\}\}', value, text)
        if "{{" in text or "{%" in text:
            raise ValueError(
                f"{figure['caption']}: quotes what is no setting; allowed: snakemake.params.settings"
            )
        text = re.sub(r"\*(\w[^*]*)\*", r"\1", text.replace("``", "").replace("**", ""))
        out[name] = text.replace("\\ ", "")
    return out


def claims_page(claims: Sequence[Mapping]) -> str:
    """The ledger as a table on a page of its own."""
    body = f"<h1>Claims</h1>\n{_summary(claims)}\n{_claims_table(claims)}"
    return page("slippulse: claims", f'<main id="content">\n{body}\n</main>')


def scenes_page(scenes: Mapping[str, str]) -> str:
    """The list of scenes, beside their pages."""
    cards = "".join(
        f'<figure><a href="{escape(name)}.html"><img src="{escape(name)}.png" alt="{escape(title)}" loading="lazy"></a>'
        f"<figcaption>{link(f'{name}.html', title)} ({link(f'{name}.gif', 'animation')})</figcaption></figure>\n"
        for name, title in scenes.items()
    )
    return page(
        "slippulse: scenes",
        f'<main id="content">\n<h1>Scenes</h1>\n<p>{link("../index.html", "All results")}</p>\n'
        f'<div class="grid">\n{cards}</div>\n</main>',
    )
