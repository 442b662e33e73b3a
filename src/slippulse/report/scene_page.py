"""The page of one scene, with its figure inside, and the list of all scenes."""

import base64
import math
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from ..data.numerals import number, rounded, setting, with_uncertainty
from ..model.prestress import prestress_from
from .html import page

SHOWN = (
    "boundary", "left", "right", "width", "peak", "steps_and_bumps", "gamma", "beta", "damping_ratio", "dx",
    "duration", "release", "scheme", "max_step", "order", "steps", "block_updates", "energy_residual", "min_velocity",
    "min_stuck_stress", "re_releases", "pulse_state", "run_flags",
)  # fmt: skip
NONE = "\N{EN DASH}"


def scene_page(
    name: str, title: str, png: str | Path, numbers: pd.DataFrame, attributes: Mapping
) -> str:
    """A page that stands alone, with its figure; ``attributes``: of the data, with the state of the leading pulse."""
    shown = {key: attributes[key] for key in SHOWN if key in attributes}
    if "steps_and_bumps" in shown:
        # In words, what its pre-stress has beside the Gaussian and its levels.
        profile, bump = (
            prestress_from(attributes),
            "bump of {1:s} and width {2:s} at x = {0:s}".format,
        )
        parts = [f"step to {setting(level)} at x = {setting(at)}" for at, level in profile.steps]
        shown["steps_and_bumps"] = "; ".join(
            [*parts, *(bump(*map(setting, each)) for each in profile.bumps)]
        )
    return page(
        "scene.html",
        name=name,
        title=title,
        picture=base64.b64encode(Path(png).read_bytes()).decode("ascii"),
        pulse_state=attributes.get("pulse_state", "none"),
        promised="promised" in numbers,
        numbers=[_number(row) for row in numbers.itertuples()],
        parameters={key.replace("_", " "): value for key, value in shown.items()},
    )


def scenes_page(scenes: Mapping[str, str]) -> str:
    """The list of scenes, titles by name, in the folder of their pages."""
    return page("scenes.html", scenes=scenes)


def _number(row) -> dict[str, str]:
    found = {"label": row.label, "measured": with_uncertainty(row.value, row.uncertainty, "(?)")}
    found |= {"theory": NONE, "difference": NONE, "promise": "not covered"}
    if math.isfinite(row.theory):
        found["theory"] = number(row.theory, 5)
        difference = row.value / row.theory - 1.0 if row.theory != 0.0 else math.nan
        if math.isfinite(difference):
            found["difference"] = f"{'+' * (difference > 0.0)}{rounded(100.0 * difference, 2)} %"
    if math.isfinite(getattr(row, "promised", math.nan)):
        found["promise"] = (
            f"{row.promised:g}, {'kept' if str(row.kept).lower() == 'true' else 'missed'}"
        )
    return found
