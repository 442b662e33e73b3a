"""The note at the top of a report whose run is not the shipped one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..data.alterations import changes
from ..data.numerals import short


def alteration_note(
    config: Mapping, shipped: Mapping, claims: Iterable[Mapping], verdicts: Mapping[str, str]
) -> str:
    """What differs from the shipped run, as Markdown; empty if nothing does.

    Parameters
    ----------
    config, shipped : the run's configuration and the shipped one
    claims : the run's ledger
    verdicts : shipped verdict of each claim
    """
    altered = [
        f"`{change['key']}`: {_code(change['here'])} (shipped: {_code(change['shipped'])})"
        for change in changes(shipped, config)
    ]
    judged = [
        f"`{claim['id']}`: {claim['verdict']} (shipped: {verdicts.get(claim['id'], 'absent')})"
        for claim in claims
        if claim["verdict"] != verdicts.get(claim["id"])
    ]
    lines = []
    if altered:
        lines.append(
            "**Altered configuration.** This run differs from the shipped configuration in "
            f"{'; '.join(altered)}."
        )
    if judged:
        lines.append(f"**Verdicts that differ from the shipped report:** {'; '.join(judged)}.")
    elif altered:
        lines.append("No verdict differs from the shipped report.")
    return "\n>\n".join(f"> {line}" for line in lines)


def _code(value: object) -> str:
    return "absent" if value is None else "`" + short(value).replace("`", "'") + "`"
