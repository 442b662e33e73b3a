"""What a run's configuration and verdicts have that the shipped ones have not."""

from __future__ import annotations

from collections.abc import Mapping

ABSENT = "absent"


def altered_keys(config: Mapping, shipped: Mapping, prefix: str = "") -> list[tuple[str, object, object]]:
    """Keys at which two configurations differ, dotted, with the run's value and the shipped one.

    Parameters
    ----------
    config, shipped : nested mappings of builtins
    prefix : key of these mappings in the whole
    """
    found = []
    for key in sorted({*config, *shipped}, key=str):
        name = f"{prefix}{key}"
        ours, theirs = config.get(key, ABSENT), shipped.get(key, ABSENT)
        if isinstance(ours, Mapping) and isinstance(theirs, Mapping):
            found += altered_keys(ours, theirs, f"{name}.")
        elif ours != theirs:
            found.append((name, ours, theirs))
    return found


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
    keys = altered_keys(config, shipped)
    changed = altered_verdicts(claims, verdicts)
    lines = []
    if keys:
        listed = "; ".join(
            f"`{key}`: `{_short(ours)}` (shipped: `{_short(theirs)}`)" for key, ours, theirs in keys
        )
        lines.append(
            f"**Altered configuration.** This run differs from the shipped configuration in {listed}."
        )
    if changed:
        listed = "; ".join(f"`{id}`: {now} (shipped: {before})" for id, now, before in changed)
        lines.append(f"**Verdicts that differ from the shipped report:** {listed}.")
    elif keys:
        lines.append("No verdict differs from the shipped report.")
    return "\n".join(f"> {line}\n>" for line in lines).rstrip(">")


def _short(value: object, longest: int = 80) -> str:
    text = str(value).replace("`", "'")
    return text if len(text) <= longest else text[: longest - 3] + "..."
