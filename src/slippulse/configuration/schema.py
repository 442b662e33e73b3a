"""Every key of the configuration, once: type, range, default, meaning with unit and origin.

From these come the refusals (`problems`), and through `python -m slippulse.configuration.describe` the JSON Schema in
workflow/schemas and the tables of config/README.md.
"""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from ..measure.quantities import QUANTITIES
from ..model.checks import nearest, short_repr
from .keys import (
    Block,
    Count,
    Distinct,
    Fraction,
    Name,
    NonNegative,
    Positive,
    Release,
    Scheme,
    Spacing,
    allowed,
    require,
)
from .simulations import NamedScene, Simulation


class Preset(Block):
    """One trade of speed for accuracy."""

    dx: Spacing = Field(description="block spacing where a simulation does not scale it [H]")
    max_step: Positive = Field(description="largest time step; strong damping may need less [dx]")
    order: int = Field(ge=3, le=8, description="order of the Taylor step")
    coarser: Annotated[Distinct[Annotated[float, Field(gt=1.0)]], Field(min_length=2, max_length=2)] = Field(
        description="factors of the spacing in the grid study behind every uncertainty",
        json_schema_extra=allowed("two different factors > 1"),
    )
    whole: bool = Field(True, description="whether studies, ledger and report are made without `everything`")


class Model(Block):
    """What holds for every simulation that does not say otherwise."""

    damping_ratio: NonNegative = Field(description="beta/dx (paper: beta = 1e-3; figure: dx = 0.01)")
    release: Release = Field(
        description="whether stress at release has the damping force (`total`) or not (figure; `elastic` is printed)"
    )
    scheme: Scheme = Field(
        description="`localised`: every release and stick at its instant; `fixed_step`: the textbook scheme;"
        " `continuum`: the exact solution of the continuum limit, to which `max_step` and `order` mean nothing"
    )
    friction_ratio: NonNegative = Field(
        description="mu_k/(mu_s - mu_k): beyond stress -(1 + 2 friction_ratio) blocks slide back: flagged"
    )
    resolved_blocks: Count = Field(
        description="a pulse of fewer blocks (under a stress boundary: a Gaussian of fewer) is flagged as unresolved"
    )


class Measure(Block):
    """How numbers are read off a run."""

    share: Fraction = Field(
        description="under a stress boundary T_trans is when the left front has covered this fraction of |x_minus|; the"
        " arrest itself never comes in the continuum"
    )
    front_window: float = Field(
        ge=0.05, lt=1.0, description="a front speed is a straight line through this last fraction of its path"
    )
    steady_tolerance: Fraction = Field(
        description="a largest velocity changing less over the last third is steady"
    )
    trailing_times: Distinct[Positive] = Field(
        description="when the trailing edge is tabulated [H/c] (figure)"
    )
    still: Fraction = Field(description="slower than this fraction of the largest slip velocity is at rest")


class Sketch(Block):
    """The layer of figure 1."""

    thickness: float = Field(ge=0.01, le=100.0, description="of the layer in the sketch [H]")
    strip_width: float = Field(ge=0.01, le=2.0, description="of the integrated strip in the sketch [H]")


Ratio = Annotated[float, Field(ge=1e-6, le=1e6)]


class Steps(Block):
    """Numbers in steps of equal ratio."""

    from_: Ratio = Field(alias="from", description="the first")
    to: Ratio = Field(description="the last, above the first")
    count: int = Field(ge=2, le=10_000, description="how many")

    @model_validator(mode="after")
    def _upwards(self) -> Self:
        require(self.to > self.from_, f"to: {self.to}; allowed: > from = {self.from_}")
        return self


class DamageZone(Block):
    """The curves of figure 7."""

    stiffness_ratios: Steps = Field(description="G/G_r")
    thickness_ratios: Distinct[Ratio] = Field(description="H_r/H, one curve each")


class Figures(Block):
    """Settings of figures that draw no simulation."""

    fig01_system_sketch: Sketch = Field(description="the sketch of the system")
    fig07_damage_zone: DamageZone = Field(description="the damage zone")


class Claim(Block):
    """When a claim counts as reproduced, in place of what stands with it in manuscript/claims.yaml."""

    tolerance: NonNegative | None = Field(None, description="what counts as agreement, by kind")
    tolerance_exponent: Positive | None = Field(
        None, description="of an approximate claim: largest distance of the exponent from 1"
    )


class Reading(Block):
    """A number read off a published figure."""

    simulation: str = Field(description="name of the simulation whose run is compared with it")
    quantity: str = Field(description="which of its measured numbers: a column of the measured table")
    statement: str = Field(min_length=1, description="what was read off (figure)")
    value: float = Field(description="the number (figure)")
    reading_error: Positive = Field(description="of reading by pixel")


class Configuration(Block):
    """The whole configuration."""

    preset: str = Field(
        description="which of `presets` is used", json_schema_extra=allowed("the name of a preset")
    )
    presets: dict[str, Preset] = Field(min_length=1, description="trades of speed for accuracy, by name")
    accuracy: Annotated[float, Field(ge=1e-4, le=0.1)] | None = Field(
        None,
        description="largest relative numerical error of measured numbers, instead of a preset's spacing and step",
    )
    allow_large: bool = Field(False, description="whether simulations above the limits of cost run")
    model: Model = Field(description="for every simulation that does not say otherwise")
    simulations: dict[Name, Simulation] = Field(description="sweeps by name, each the product of its lists")
    scenes: dict[Name, NamedScene] = Field({}, description="single runs by name")
    measure: Measure = Field(description="how numbers are read off a run")
    figures: Figures = Field(description="of figures that draw no simulation")
    claims: dict[str, Claim] = Field(
        {}, description="other tolerances than those of manuscript/claims.yaml, by claim"
    )
    published: dict[str, Reading] = Field(description="numbers read off a published figure, by name")
    studies: Distinct[Name] | None = Field(
        None,
        description="studies run for their tables, by name; by default all",
        json_schema_extra=allowed("a list of different names, at least one"),
    )

    @model_validator(mode="after")
    def _names(self) -> Self:
        hint = nearest(self.preset, self.presets)
        text = f"preset: {short_repr(self.preset)}{hint}; allowed: {', '.join(self.presets)}"
        require(self.preset in self.presets, text)
        require(
            self.accuracy is None or self.model.scheme == "localised",
            f"model.scheme: {self.model.scheme!r}; allowed: 'localised' where accuracy is given",
        )
        for name in self.scenes:
            taken = name == "index" or name.removesuffix("_numbers") in {*self.scenes} - {name}
            require(
                name not in self.simulations,
                f"scenes.{name}: also the name of a simulation; allowed: another name",
            )
            require(
                not taken,
                f"scenes.{name}: another file of that name is there; allowed: neither index nor SCENE_numbers",
            )
        known = QUANTITIES | {f"trailing_edge_{time:g}": "fronts" for time in self.measure.trailing_times}
        for key, reading in self.published.items():
            name, quantity = reading.simulation, reading.quantity
            require(
                name in self.simulations,
                f"published.{key}.simulation: {short_repr(name)}{nearest(name, self.simulations)};"
                " allowed: a name under simulations",
            )
            text = f"published.{key}.quantity: {short_repr(quantity)}"
            require(
                quantity in known,
                f"{text}{nearest(quantity, known)}; allowed: a column of the measured table",
            )
            require(
                known[quantity] in ("fronts", *self.simulations[name].record),
                f"{text}; allowed: what simulations.{name} records; this takes record: [fronts, {known[quantity]}]",
            )
        return self
