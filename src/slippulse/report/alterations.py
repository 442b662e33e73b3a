"""What a run's configuration and verdicts have that the shipped ones have not."""

from __future__ import annotations

from collections.abc import Mapping

from ..configuration.alterations import alterations

ABSENT = "absent"


def altered_verdicts(claims: list[dict], shipped: Mapping[str, str]) -> list[tuple[str, str, str]]:
    """Claims whose verdict differs from the shipped one: id, verdict, shipped verdict."""
    found = []
    for claim in claims:
        before = shipped.get(claim["id"], ABSENT)
        if claim["verdict"] != before:
            found.append((claim["id"], claim["verdict"], before))
    return found


def alteration_note(
    config: Mapping, shipped: Mapping, claims: list[dict], verdicts: Mapping[str, str]
) -> str:
    """The note at the top of a report whose run is not the shipped one, as Markdown; empty if it is.

    Parameters
    ----------
    config, shipped : the run's configuration and the shipped one
    claims : the run's ledger
    verdicts : shipped verdict of each claim
    """
    altered = alterations(config, shipped)
    changed = altered_verdicts(claims, verdicts)
    lines = []
    if altered:
        listed = "; ".join(
            f"`{entry['key']}`: `{_short(entry['here'])}` (shipped: `{_short(entry['shipped'])}`)"
            for entry in altered
        )
        lines.append(
            f"**Altered configuration.** This run differs from the shipped configuration in {listed}."
        )
    if changed:
        listed = "; ".join(f"`{id}`: {now} (shipped: {before})" for id, now, before in changed)
        lines.append(f"**Verdicts that differ from the shipped report:** {listed}.")
    elif altered:
        lines.append("No verdict differs from the shipped report.")
    return "\n".join(f"> {line}\n>" for line in lines).rstrip(">")


def _short(value: object, longest: int = 80) -> str:
    text = ABSENT if value is None else str(value).replace("`", "'")
    return text if len(text) <= longest else text[: longest - 3] + "..."
