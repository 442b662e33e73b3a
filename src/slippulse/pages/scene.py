"""The page of one scene: its figure, its numbers beside theory, its parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from pathlib import Path

import pandas as pd

from .layout import embedded_png, link, page, table_html

SHOWN = (
    "boundary", "left", "right", "width", "peak", "steps_and_bumps", "gamma", "beta", "damping_ratio", "dx",
    "duration", "release", "scheme", "max_step", "order", "steps", "block_updates", "energy_residual", "min_velocity",
    "min_stuck_stress", "re_releases", "flags",
)  # fmt: skip


def scene_page(name: str, title: str, png: str | Path, numbers: pd.DataFrame, attributes: Mapping) -> str:
    """A page that stands alone.

    Parameters
    ----------
    name, title : of the scene
    png : its figure
    numbers : measured, with uncertainty and theory (`slippulse.measure.beside_theory.scene_numbers`); a promised
        accuracy, where there is one, is stated with whether it is kept
    attributes : of the run's data
    """
    alt = (
        f"{title}. Slip velocity over time and position with the fronts and where blocks stick; below, slip velocity"
        " and slip at the end."
    )
    rows = [
        (
            row.label,
            f"{row.value:.6g}",
            _shown(row.uncertainty, ".1g"),
            _shown(row.theory, ".6g"),
            _miss(row),
            *_promise(row),
        )
        for row in numbers.itertuples()
    ]
    promise = ("promised accuracy",) if "promised" in numbers else ()
    parameters = [(key.replace("_", " "), _value(attributes[key])) for key in SHOWN if key in attributes]
    body = "\n".join(
        [
            f'<main id="content">\n<h1>{escape(title)}</h1>',
            f"<figure>{embedded_png(png, alt)}<figcaption>Scene {escape(name)}. Beside this page: "
            f"{link(f'{name}.pdf', 'PDF')}, {link(f'{name}.csv', 'what is drawn')}, "
            f"{link(f'data/{name}.nc', 'the data')}; an animation, {link(f'{name}.gif', f'{name}.gif')}, is made by "
            f"<code>snakemake results/scenes/{escape(name)}.gif</code>.</figcaption></figure>",
            "<h2>Numbers</h2>",
            table_html(
                "Measured, with the uncertainty of a study on two coarser lattices, beside exact theory",
                ("quantity", "measured", "uncertainty", "theory", "difference", *promise),
                rows,
                numeric=(1, 2, 3, 4),
            ),
            "<p>Theory is the steady state far from nucleation and the continuum limit of the transition; a short run"
            " has not reached the one, a coarse lattice not the other.</p>",
            "<h2>Parameters</h2>",
            table_html("The run", ("parameter", "value"), parameters),
            "</main>",
        ]
    )
    return page(f"{title} (scene {name})", body)


def _shown(value: float, form: str) -> str:
    return f"{value:{form}}" if math.isfinite(value) else "\N{EN DASH}"


def _miss(row) -> str:
    if not math.isfinite(row.theory) or row.theory == 0.0:
        return "\N{EN DASH}"
    return f"{100.0 * (row.value / row.theory - 1.0):+.2g} %"


def _promise(row) -> tuple[str, ...]:
    """Relative, with what the grid study says of it; nothing where none was asked for."""
    if not hasattr(row, "promised"):
        return ()
    if not math.isfinite(row.promised):
        return ("not covered",)
    return (f"{row.promised:g}, {'kept' if str(row.kept).lower() == 'true' else 'missed'}",)


def _value(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value) or "none"
