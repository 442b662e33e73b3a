"""The page of one scene, with its figure inside."""

import base64
import math
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from slippulse.model.prestress import prestress_from
from slippulse.model.recorded_law import law_of

from ..text.numerals import number, rounded, setting, with_uncertainty
from .html import page

PHYSICS = ("boundary", "left", "right", "width", "peak", "steps_and_bumps", "gamma", "beta")
LATTICE = ("damping_ratio", "dx", "duration", "release", "scheme", "max_step", "order", "steps")
WORK = ("block_updates", "energy_residual", "min_velocity", "min_stuck_stress", "re_releases")
SHOWN = (*PHYSICS, "friction", *LATTICE, *WORK, "pulse_state", "run_flags")
NONE = "\N{EN DASH}"


def scene_page(
    name: str, title: str, png: str | Path, numbers: pd.DataFrame, attributes: Mapping, note: str
) -> str:
    """A page with its figure inside; ``note`` says what an altered configuration changed."""
    shown = {key: attributes[key] for key in SHOWN if key in attributes}
    if "steps_and_bumps" in shown:
        profile, parts = prestress_from(attributes), []
        if profile.points:
            ends = f"x = {setting(profile.points[0][0])} to {setting(profile.points[-1][0])}"
            parts.append(f"linear between {len(profile.points)} points from {ends}")
        if profile.width is None:
            shown["width"] = "no Gaussian at x = 0"
            shown.pop("peak", None)
        for x, level in profile.steps:
            parts.append(f"step to {setting(level)} at x = {setting(x)}")
        for x, amplitude, width in profile.bumps:
            size = f"{setting(amplitude)} and width {setting(width)}"
            parts.append(f"bump of {size} at x = {setting(x)}")
        shown["steps_and_bumps"] = "; ".join(parts)
    if "friction" in shown:
        law = law_of(attributes)
        words = [law.pop("law").replace("_", " ")]
        words += [f"{key} = {setting(value)}" for key, value in law.items()]
        shown["friction"] = ", ".join(words)
    return page(
        "scene.html",
        name=name,
        title=title,
        note=note,
        picture=base64.b64encode(Path(png).read_bytes()).decode("ascii"),
        pulse_state=attributes.get("pulse_state", "none"),
        promised="promised" in numbers,
        numbers=[_number(row) for row in numbers.itertuples()],
        parameters={key.replace("_", " "): value for key, value in shown.items()},
    )


def _number(row) -> dict[str, str]:
    """Cells of one measured number."""
    cells = {"label": row.label, "measured": with_uncertainty(row.value, row.uncertainty, "(?)")}
    cells |= {"theory": NONE, "difference": NONE, "promise": "not covered"}
    if math.isfinite(row.theory):
        cells["theory"] = number(row.theory, 5)
        difference = row.value / row.theory - 1.0 if row.theory != 0.0 else math.nan
        if math.isfinite(difference):
            sign = "+" if difference > 0.0 else ""
            cells["difference"] = f"{sign}{rounded(100.0 * difference, 2)} %"
    if math.isfinite(getattr(row, "promised", math.nan)):
        outcome = "kept" if str(row.kept).lower() == "true" else "missed"
        cells["promise"] = f"{row.promised:g}, {outcome}"
    return cells
