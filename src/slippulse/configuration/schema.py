"""Every key of the configuration, once: type, range, default, meaning with unit (in brackets) and origin.

From these come the refusals (`problems`), and through docs/describe.py the JSON Schema in
workflow/schemas and the tables of config/README.md.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from ..measure.quantities import QUANTITIES
from ..model.checks import nearest, short_repr

T = TypeVar("T")


class Block(BaseModel):
    """A mapping of the configuration: no keys but its own, no conversions, finite numbers."""

    model_config = ConfigDict(
        extra="forbid", strict=True, allow_inf_nan=False, defer_build=True, serialize_by_alias=True
    )

    def given(self) -> dict[str, Any]:
        """What was given, as builtins."""
        return self.model_dump(mode="json", exclude_unset=True)

    def plain(self) -> dict[str, Any]:
        """The same with its defaults, without what has none."""
        return self.model_dump(mode="json", exclude_none=True)


def allowed(words: str) -> dict[str, Any]:
    """What a key allows, where its type does not say it in words."""
    return {"allowed": words}


def require(condition: bool, problem: str) -> None:
    """Raise with a problem, as "key: value; allowed: ...", unless a condition holds."""
    if not condition:
        raise ValueError(problem)


def _all_different(values: list[T]) -> list[T]:
    if len({repr(value) for value in values}) < len(values):
        raise PydanticCustomError("different", "an entry twice")
    return values


# A list of different entries, at least one.
Distinct = Annotated[
    list[T], Field(min_length=1, json_schema_extra={"uniqueItems": True}), AfterValidator(_all_different)
]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Spacing = Annotated[float, Field(gt=0.0, le=1.0)]
Count = Annotated[int, Field(ge=1)]
Boundary = Literal["displacement", "stress"]
Release = Literal["total", "elastic"]
Scheme = Literal["localised", "fixed_step", "continuum"]
Record = Literal["fronts", "fields", "samples"]
# Rows of numbers, which YAML has as lists.
Step = Annotated[tuple[float, float], Field(strict=False)]
Bump = Annotated[tuple[float, float, float], Field(strict=False)]
NAME_WORDS = "a name of lower-case letters, digits and underscores that begins with a letter"
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
Title = Annotated[
    str,
    Field(
        max_length=120,
        pattern=r"^[^\x00-\x1f\x7f-\x9f]*[^\s\x00-\x1f\x7f-\x9f][^\x00-\x1f\x7f-\x9f]*$",
        json_schema_extra=allowed("one line of at most 120 printable characters, not blank"),
    ),
]

ROWS_OF_STEPS, ROWS_OF_BUMPS = "a list of [position, level]", "a list of [centre, amplitude, width]"
UNITS, RULE = "one of time, half_periods, balance_distances", "fixed, or scale, width_power and gamma_power"
RECORDED = "a list of fronts (always: all is measured from them), fields, samples"


class Profile(Block):
    """One pre-stress."""

    left: float = Field(description="level of the pre-stress far to the left [S]")
    right: float = Field(description="level far to the right [S]")
    width: Positive = Field(
        1.0, description="standard deviation W of the Gaussian at nucleation, >= dx [H] (paper)"
    )
    peak: float = Field(1.0, description="value at x = 0; the pre-stress must reach 1 somewhere [S] (paper)")
    steps: list[Step] = Field(
        [],
        description="beyond each position, away from x = 0, its level holds [H, S]",
        json_schema_extra=allowed(ROWS_OF_STEPS),
    )
    bumps: list[Bump] = Field(
        [], description="Gaussians that are added [H, S, H]", json_schema_extra=allowed(ROWS_OF_BUMPS)
    )


class Beyond(Block):
    """Another level on one side, one run a level."""

    position: float = Field(
        description="from here on, away from x = 0 and not there, the level is replaced [H]"
    )
    levels: Distinct[float] = Field(description="by each of these in turn [S]")


class Duration(Block):
    """How long a run is, in one of three units."""

    time: Positive | None = Field(None, description="the duration itself [H/c]")
    half_periods: Positive | None = Field(None, description="in pi/sqrt(gamma); under `displacement`")
    balance_distances: Positive | None = Field(None, description="in |x_minus|; left level < 0, right 0")


class SpacingRule(Block):
    """A rule for the block spacing: the preset's dx times scale W^width_power gamma^gamma_power, or a fixed one."""

    fixed: Spacing | None = Field(None, description="the spacing, in the grid study too; alone [H]")
    scale: Positive = Field(1.0, description="factor of the preset's dx")
    width_power: float = Field(0.0, description="power of W")
    gamma_power: float = Field(0.0, description="power of gamma; under `displacement`")


class Recording(Block):
    """Where and when slip and slip velocity are sampled."""

    times: int = Field(ge=2, le=100_000, description="how many, evenly over the duration")
    positions: int = Field(ge=1, le=100_000, description="how many, from -extent to extent; 1: at x = 0")
    extent: NonNegative = Field(description="how far to each side [H]")


class Physics(Block):
    """What a simulation and a scene share."""

    boundary: Boundary = Field(description="held on top: displacement (Gamma = 1) or stress (Gamma = 0)")
    scheme: Scheme | None = Field(None, description="by default the model's")
    resolved_blocks: Count | None = Field(None, description="by default the model's")
    max_step: Positive | None = Field(None, description="by default the preset's, cut to the bound [dx]")

    def alone(self, key: str, *others: str) -> None:
        """Refuse a key that is given with another."""
        given = [other for other in (key, *others) if other in self.model_fields_set]
        text = f"{key}: given with {', '.join(given[1:])}; allowed: one or the other (null removes a key)"
        require(key not in given or len(given) == 1, text)

    @model_validator(mode="after")
    def _physics(self) -> Self:
        gamma, springs = getattr(self, "gamma", None), self.boundary == "displacement"
        require(
            not springs or gamma is not None, "gamma: missing; allowed: > 0 under boundary 'displacement'"
        )
        require(
            springs or gamma is None,
            f"gamma: {gamma!r}; allowed: left out under boundary 'stress', which has no leaf springs"
            " (gamma: null removes it)",
        )
        self.alone("beta", "damping_ratio")
        return self


class Simulation(Physics):
    """A sweep: the product of its lists."""

    left: Distinct[float] | None = Field(None, description="pre-stress levels on the left, below 1 [S]")
    right: Literal["same"] | Distinct[float] | None = Field(None, description="on the right [S]")
    width: Distinct[Positive] = Field([1.0], description="widths W of the Gaussian at nucleation, >= dx [H]")
    profiles: Distinct[Profile] | None = Field(
        None,
        description="whole profiles, below, instead of the three above",
        json_schema_extra=allowed("a list of different profiles, at least one"),
    )
    beyond: Beyond | None = Field(None, description="another level on one side, below")
    gamma: Distinct[Positive] | None = Field(
        None, description="elasticity ratio 2G/(lambda + 2G); left out under `stress` (paper: near 2/3)"
    )
    damping_ratio: Distinct[NonNegative] | None = Field(None, description="beta/dx; by default the model's")
    beta: Distinct[NonNegative] | None = Field(None, description="damping, instead of `damping_ratio` [H]")
    rate_strengthening: Distinct[float] | None = Field(
        None,
        description="alpha, friction that grows (> 0) or weakens (< 0) with slip rate; by default 0 [c/H]",
    )
    duration: Duration = Field(
        description="how long each run is, in one of three units, below", json_schema_extra=allowed(UNITS)
    )
    spacing: SpacingRule = Field(
        SpacingRule(), description="a rule for the block spacing, below", json_schema_extra=allowed(RULE)
    )
    dx: Distinct[Spacing] | None = Field(None, description="block spacings, instead of `spacing` [H]")
    release: Release | Distinct[Release] | None = Field(
        None,
        description="by default the model's",
        json_schema_extra=allowed("total, elastic, or a list of both"),
    )
    friction_ratio: NonNegative | None = Field(None, description="by default the model's")
    record: Distinct[Record] = Field(
        description="what is kept: release and stick times; slip, velocity and acceleration at the end; samples",
        json_schema_extra=allowed(RECORDED),
    )
    samples: Recording | None = Field(None, description="what `record: [fronts, samples]` samples, below")
    chunks: int = Field(1, ge=1, le=1000, description="how many jobs share the sweep, at most a run each")

    @model_validator(mode="after")
    def _together(self) -> Self:
        self.alone("profiles", "left", "right", "width", "beyond")
        self.alone("dx", "spacing")
        rule, units = self.spacing.model_fields_set, sorted(self.duration.model_fields_set)
        springs, recorded = self.boundary == "displacement", "samples" in self.record
        levels = self.left is not None and self.right is not None
        require(levels or self.profiles is not None, "left, right: missing; allowed: lists, or profiles")
        require(rule == {"fixed"} or "fixed" not in rule, "spacing.fixed: given with others; allowed: alone")
        require(len(units) == 1, f"duration: {units}; allowed: {UNITS} (null removes a key)")
        only = "given; allowed: only under boundary 'displacement'"
        require(springs or "half_periods" not in units, f"duration.half_periods: {only}")
        require(springs or "gamma_power" not in rule, f"spacing.gamma_power: {only}")
        require("fronts" in self.record, f"record: {self.record}; allowed: {RECORDED}")
        require(
            self.samples is not None or not recorded,
            "samples: missing; allowed: times, positions and extent when record has 'samples'",
        )
        require(
            self.samples is None or recorded,
            "samples: given, but not recorded; allowed: with samples in record (samples: null removes it)",
        )
        return self


class NamedScene(Profile, Physics):
    """One run by name."""

    title: Title = Field(description="one line above figure and page")
    gamma: Positive | None = Field(None, description="as under `simulations` (paper: near 2/3)")
    damping_ratio: NonNegative | None = Field(None, description="beta/dx; by default the model's")
    beta: NonNegative | None = Field(None, description="damping, instead of `damping_ratio` [H]")
    rate_strengthening: float | None = Field(None, description="alpha, as under `simulations` [c/H]")
    dx: Spacing | None = Field(None, description="block spacing; by default the preset's [H]")
    release: Release | None = Field(None, description="by default the model's")
    duration: Positive = Field(description="how long the run is [H/c]")


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
    arrow: bool = Field(
        False, description="whether it is a drawn arrow, which the best fit is found with and without"
    )


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
