"""Write the page of one scene: its figure, its numbers compared with theory, its parameters."""

import base64
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from slippulse.data.readable_units import readable_unit
from slippulse.model.layer_units import Layer
from slippulse.model.prestress import prestress_from
from slippulse.model.recorded_law import read_recorded_law
from slippulse.model.scene import EXTRA_TERMS
from slippulse.model.si_quantities import QUANTITIES

from ..text.numerals import number, rounded, setting, with_uncertainty
from .html import page

# Attributes of a run that the page shows, in this order.
PHYSICAL = ("boundary", "left", "right", "width", "peak", "steps_and_bumps", "gamma", "beta")
NUMERICAL = ("damping_ratio", "dx", "duration", "release", "scheme", "max_step", "order", "steps")
OUTCOMES = ("block_updates", "energy_residual", "min_velocity", "min_stuck_stress", "re_releases")
SHOWN = (*PHYSICAL, *EXTRA_TERMS, "friction", *NUMERICAL, *OUTCOMES, "pulse_state", "run_flags")
NO_NUMBER = "\N{EN DASH}"


def scene_page(
    name: str,
    title: str,
    png: str | Path,
    numbers: pd.DataFrame,
    attributes: Mapping,
    note: str,
    layer: Layer | None = None,
) -> str:
    """Return the page as HTML, which contains the figure.

    png : path of the figure
    numbers : table from `main_numbers.scene_numbers` or `main_numbers.numbers_in_si`; the column
        "promised", which is optional, has the accuracy that the configuration requires
    attributes : parameters of the run, in units of the model
    note : which values of the configuration were altered; empty if none
    layer : if given, the page shows all numbers in SI units
    """
    shown = _parameters(attributes, layer)
    return page(
        "scene.html",
        name=name,
        title=title,
        note=note,
        picture=base64.b64encode(Path(png).read_bytes()).decode("ascii"),
        pulse_state=attributes.get("pulse_state", "none"),
        promised="promised" in numbers,
        numbers=[_number_cells(row) for row in numbers.itertuples()],
        parameters={key.replace("_", " "): value for key, value in shown.items()},
        layer=_layer_rows(layer) if layer is not None else None,
        scales=_scale_rows(layer) if layer is not None else None,
    )


def _parameters(attributes: Mapping, layer: Layer | None) -> dict[str, Any]:
    """Return the parameters of the run that the page shows, in SI units if there is a layer."""
    shown = {key: attributes[key] for key in SHOWN if key in attributes}
    if "steps_and_bumps" in shown:
        shown["steps_and_bumps"] = _profile_text(attributes, layer)
    if layer is not None:
        # QUANTITIES has the parameters with a unit.
        numbers_in_si = layer.numbers_to_si(attributes)
        for key in shown.keys() & QUANTITIES.keys():
            shown[key] = _with_unit(numbers_in_si[key], QUANTITIES[key])
    if "width" in shown and not math.isfinite(attributes["width"]):
        shown["width"] = "no Gaussian at x = 0"
        shown.pop("peak", None)
    if "friction" in shown:
        shown["friction"] = _friction_text(attributes)
    return shown


def _friction_text(attributes: Mapping) -> str:
    """Return the friction law with its parameters, such as "linear rate, alpha = 0.3"."""
    law = read_recorded_law(attributes)
    parts = [law.pop("law").replace("_", " ")]
    parts += [f"{name} = {setting(value)}" for name, value in law.items()]
    return ", ".join(parts)


def _profile_text(attributes: Mapping, layer: Layer | None) -> str:
    """Describe steps, bumps and points of the pre-stress in words."""

    def write(value: float, quantity: str) -> str:
        """Return a number as text, with its unit if there is a layer."""
        if layer is None:
            return setting(value)
        return _with_unit(layer.convert_to_si(value, quantity), quantity)

    profile = prestress_from(attributes)
    parts = []
    if profile.points:
        positions = [x for x, _ in profile.points]
        first, last = write(positions[0], "length"), write(positions[-1], "length")
        parts.append(f"linear between {len(profile.points)} points from x = {first} to {last}")
    for x, level in profile.steps:
        parts.append(f"step to {write(level, 'stress')} at x = {write(x, 'length')}")
    for x, amplitude, width in profile.bumps:
        size = f"{write(amplitude, 'stress_difference')} and width {write(width, 'length')}"
        parts.append(f"bump of {size} at x = {write(x, 'length')}")
    return "; ".join(parts)


def _with_unit(value: float, quantity: str) -> str:
    """Write a number in SI units with a readable prefix."""
    unit = readable_unit(quantity, value)
    return f"{rounded(value / unit.value)} {unit.text}"


def _layer_rows(layer: Layer) -> dict[str, str]:
    """Return the parameters of a layer, and the numbers that follow from them."""
    rows = {
        "thickness H": _with_unit(layer.thickness, "length"),
        "shear modulus G": _with_unit(layer.shear_modulus, "stress"),
    }
    if layer.poisson_ratio is not None:
        rows["Poisson's ratio"] = setting(layer.poisson_ratio)
    if layer.lame_parameter is not None:
        rows["Lamé parameter λ"] = _with_unit(layer.lame_parameter, "stress")
    return rows | {
        "density": f"{setting(layer.density)} kg/m³",
        "static friction": setting(layer.static_friction),
        "kinetic friction": setting(layer.kinetic_friction),
        "normal stress": _with_unit(layer.normal_stress, "stress"),
        "on top": f"the {'displacement' if layer.top == 'held' else 'shear stress'} is held",
        "elasticity ratio γ = 2G/(λ + 2G)": rounded(layer.gamma),
        "wave speed": _with_unit(layer.wave_speed, "speed"),
        "static friction μ_s σ_n": _with_unit(layer.static_strength, "stress"),
        "kinetic friction μ_k σ_n": _with_unit(layer.kinetic_strength, "stress"),
    }


def _scale_rows(layer: Layer) -> dict[str, str]:
    """Return the units in which the model measures length, time and so on, in SI units."""
    scales = layer.scales._asdict()
    return {name.replace("_", " "): _with_unit(value, name) for name, value in scales.items()}


def _number_cells(row) -> dict[str, str]:
    """Return the cells of one row of the table of measured numbers, by the name of their column.

    row : a row of the table of numbers; the columns promised, kept, unit and paper may be missing
    """
    promised, paper = getattr(row, "promised", math.nan), getattr(row, "paper", math.nan)
    promise = "not covered"
    if math.isfinite(promised):
        # The column has the texts true and false, or booleans if it was read from a file.
        outcome = "kept" if str(row.kept).lower() == "true" else "missed"
        promise = f"{promised:g}, {outcome}"
    return {
        "label": row.label,
        "measured": with_uncertainty(row.value, row.uncertainty, unknown="(?)"),
        "unit": getattr(row, "unit", ""),
        "paper": NO_NUMBER if math.isnan(paper) else number(paper, 5),
        "theory": number(row.theory, 5) if math.isfinite(row.theory) else NO_NUMBER,
        "difference": _difference_text(row.value, row.theory),
        "promise": promise,
    }


def _difference_text(measured: float, theory: float) -> str:
    """Return the relative difference of a measured number from theory, as a percentage."""
    if theory == 0.0 or not (math.isfinite(theory) and math.isfinite(measured)):
        return NO_NUMBER
    difference = measured / theory - 1.0
    sign = "+" if difference > 0.0 else ""
    return f"{sign}{rounded(100.0 * difference, 2)} %"
