"""Every key of the configuration, once: type, range, default, meaning with unit (in brackets) and origin.

From these come the refusals (`read`), and by docs/describe.py the JSON Schema and the tables of config/README.md.
What a key says of a mapping is not said again of its class.
"""

from collections.abc import Iterable
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from ..model.checks import short_repr
from ..model.quantities import QUANTITIES
from .problems import nearest

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


def key(description: str, default: Any = ..., words: str | None = None, **limits: Any) -> Any:
    """A key of a mapping; what it allows in words, where its type does not say it."""
    extra: dict[str, Any] = {"json_schema_extra": {"allowed": words}} if words else {}
    return Field(default, description=description, **extra, **limits)


def require(condition: bool, found: str, allowed: str) -> None:
    """Refuse a key and its value with what is allowed, unless a condition holds."""
    if not condition:
        raise ValueError(f"{found}; allowed: {allowed}")


def check_name(key: str, name: str, names: Iterable[str], allowed: str) -> None:
    """Refuse a name that is none of some, with the nearest of them."""
    if name not in names:
        raise ValueError(f"{key}: {short_repr(name)}{nearest(name, names)}; allowed: {allowed}")


def _all_different(values: list[T]) -> list[T]:
    if len({*map(repr, values)}) < len(values):
        raise PydanticCustomError("different", "an entry twice")
    return values


# A list of different entries, at least one.
Distinct = Annotated[
    list[T],
    Field(min_length=1, json_schema_extra={"uniqueItems": True}),
    AfterValidator(_all_different),
]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Spacing = Annotated[float, Field(gt=0.0, le=1.0)]
Ratio = Annotated[float, Field(ge=1e-6, le=1e6)]
Release = Literal["total", "elastic"]
Scheme = Literal["localised", "fixed_step", "continuum"]
# Rows of numbers, which YAML has as lists.
Step = Annotated[tuple[float, float], Field(strict=False)]
Bump = Annotated[tuple[float, float, float], Field(strict=False)]
NAME_WORDS = "a name of lower-case letters, digits and underscores that begins with a letter"
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f]*[^\s\x00-\x1f\x7f-\x9f][^\x00-\x1f\x7f-\x9f]*$"

TITLE = "one line of at most 120 printable characters, not blank"
STEPS, BUMPS = "a list of [position, level]", "a list of [centre, amplitude, width]"
STUDIES = "a list of different names, at least one"
UNITS, RULE = (
    "one of time, half_periods, balance_distances",
    "fixed, or scale, width_power and gamma_power",
)
RECORDED = "a list of fronts (always: all is measured from them), fields, samples"


class Profile(Block):
    """One pre-stress."""

    left: float = key("level of the pre-stress far to the left [S]")
    right: float = key("level far to the right [S]")
    width: Positive = key(
        "standard deviation W of the Gaussian at nucleation, >= dx [H] (paper)", 1.0
    )
    peak: float = key("value at x = 0; the pre-stress must reach 1 somewhere [S] (paper)", 1.0)
    steps: list[Step] = key(
        "beyond each position, away from x = 0, its level holds [H, S]", [], STEPS
    )
    bumps: list[Bump] = key("Gaussians that are added [H, S, H]", [], BUMPS)


class Beyond(Block):
    position: float = key("from here on, away from x = 0 and not there, the level is replaced [H]")
    levels: Distinct[float] = key("by each of these in turn [S]")


class Duration(Block):
    time: Positive | None = key("the duration itself [H/c]", None)
    half_periods: Positive | None = key("in pi/sqrt(gamma); under `displacement`", None)
    balance_distances: Positive | None = key("in |x_minus|; left level < 0, right 0", None)


class SpacingRule(Block):
    """The block spacing: the preset's dx times scale W^width_power gamma^gamma_power, or a fixed one."""

    fixed: Spacing | None = key("the spacing, in the grid study too; alone [H]", None)
    scale: Positive = key("factor of the preset's dx", 1.0)
    width_power: float = key("power of W", 0.0)
    gamma_power: float = key("power of gamma; under `displacement`", 0.0)


class Recording(Block):
    times: int = key("how many, evenly over the duration", ge=2, le=100_000)
    positions: int = key("how many, from -extent to extent; 1: at x = 0", ge=1, le=100_000)
    extent: NonNegative = key("how far to each side [H]")


class Physics(Block):
    """What a simulation and a scene share."""

    boundary: Literal["displacement", "stress"] = key(
        "held on top: displacement (Gamma = 1) or stress (Gamma = 0)"
    )
    scheme: Scheme | None = key("by default the model's", None)
    resolved_blocks: int | None = key("by default the model's", None, ge=1)
    max_step: Positive | None = key("by default the preset's, cut to the bound [dx]", None)

    def alone(self, key: str, *others: str) -> None:
        """Refuse a key that is given with another."""
        given = ", ".join(other for other in others if other in self.model_fields_set)
        allowed = "one or the other (null removes a key)"
        require(
            key not in self.model_fields_set or not given, f"{key}: given with {given}", allowed
        )

    @model_validator(mode="after")
    def _physics(self) -> Self:
        gamma, springs = getattr(self, "gamma", None), self.boundary == "displacement"
        require(
            not springs or gamma is not None, "gamma: missing", "> 0 under boundary 'displacement'"
        )
        none = (
            "left out under boundary 'stress', which has no leaf springs (gamma: null removes it)"
        )
        require(springs or gamma is None, f"gamma: {gamma!r}", none)
        self.alone("beta", "damping_ratio")
        return self


class Simulation(Physics):
    """A sweep: the product of its lists."""

    left: Distinct[float] | None = key("pre-stress levels on the left, below 1 [S]", None)
    right: Literal["same"] | Distinct[float] | None = key("on the right [S]", None)
    width: Distinct[Positive] = key("widths W of the Gaussian at nucleation, >= dx [H]", [1.0])
    profiles: Distinct[Profile] | None = key(
        "whole profiles, below, instead of the three above", None
    )
    beyond: Beyond | None = key("another level on one side, below", None)
    gamma: Distinct[Positive] | None = key(
        "elasticity ratio 2G/(lambda + 2G); left out under `stress` (paper: near 2/3)", None
    )
    damping_ratio: Distinct[NonNegative] | None = key("beta/dx; by default the model's", None)
    beta: Distinct[NonNegative] | None = key("damping, instead of `damping_ratio` [H]", None)
    rate_strengthening: Distinct[float] | None = key(
        "alpha, friction that grows (> 0) or weakens (< 0) with slip rate; by default 0 [c/H]", None
    )
    duration: Duration = key("how long each run is, in one of three units, below", words=UNITS)
    spacing: SpacingRule = key("a rule for the block spacing, below", SpacingRule(), RULE)
    dx: Distinct[Spacing] | None = key("block spacings, instead of `spacing` [H]", None)
    release: Release | Distinct[Release] | None = key(
        "by default the model's", None, "total, elastic, or a list of both"
    )
    friction_ratio: NonNegative | None = key("by default the model's", None)
    record: Distinct[Literal["fronts", "fields", "samples"]] = key(
        "what is kept: release and stick times; slip, velocity, acceleration at the end; samples",
        words=RECORDED,
    )
    samples: Recording | None = key("what `record: [fronts, samples]` samples, below", None)
    chunks: int = key("how many jobs share the sweep, at most a run each", 1, ge=1, le=1000)

    @model_validator(mode="after")
    def _together(self) -> Self:
        self.alone("profiles", "left", "right", "width", "beyond")
        self.alone("dx", "spacing")
        rule, units = self.spacing.model_fields_set, sorted(self.duration.model_fields_set)
        springs, recorded = self.boundary == "displacement", "samples" in self.record
        levels = self.left is not None and self.right is not None
        require(levels or self.profiles is not None, "left, right: missing", "lists, or profiles")
        require(
            rule == {"fixed"} or "fixed" not in rule, "spacing.fixed: given with others", "alone"
        )
        require(len(units) == 1, f"duration: {units}", f"{UNITS} (null removes a key)")
        only = "only under boundary 'displacement'"
        require(springs or "half_periods" not in units, "duration.half_periods: given", only)
        require(springs or "gamma_power" not in rule, "spacing.gamma_power: given", only)
        require("fronts" in self.record, f"record: {self.record}", RECORDED)
        sampled, parts = (
            self.samples is not None,
            "times, positions and extent when record has 'samples'",
        )
        require(sampled or not recorded, "samples: missing", parts)
        only = "with samples in record (samples: null removes it)"
        require(recorded or not sampled, "samples: given, but not recorded", only)
        return self


class NamedScene(Profile, Physics):
    """One run by name."""

    title: str = key(
        "one line above figure and page", ..., TITLE, max_length=120, pattern=PRINTABLE
    )
    gamma: Positive | None = key("as under `simulations` (paper: near 2/3)", None)
    damping_ratio: NonNegative | None = key("beta/dx; by default the model's", None)
    beta: NonNegative | None = key("damping, instead of `damping_ratio` [H]", None)
    rate_strengthening: float | None = key("alpha, as under `simulations` [c/H]", None)
    dx: Spacing | None = key("block spacing; by default the preset's [H]", None)
    release: Release | None = key("by default the model's", None)
    duration: Positive = key("how long the run is [H/c]")


class Preset(Block):
    dx: Spacing = key("block spacing where a simulation does not scale it [H]")
    max_step: Positive = key("largest time step; strong damping may need less [dx]")
    order: int = key("order of the Taylor step", ge=3, le=8)
    coarser: Annotated[
        Distinct[Annotated[float, Field(gt=1.0)]], Field(min_length=2, max_length=2)
    ] = key(
        "factors of the spacing in the grid study behind every uncertainty",
        words="two different factors > 1",
    )
    whole: bool = key("whether studies, ledger and report are made without `everything`", True)


class Model(Block):
    damping_ratio: NonNegative = key("beta/dx (paper: beta = 1e-3; figure: dx = 0.01)")
    release: Release = key(
        "`total`: the damping force counts at release (figure); `elastic`: not (printed)"
    )
    scheme: Scheme = key(
        "`localised`: every release and stick at its instant; `fixed_step`: the textbook scheme;"
        " `continuum`: the exact solution of the continuum limit, to which `max_step` and `order` mean nothing"
    )
    friction_ratio: NonNegative = key(
        "mu_k/(mu_s - mu_k): sliding back, beyond -(1 + 2 of it), is flagged"
    )
    resolved_blocks: int = key(
        "pulses (Gaussians, under `stress`) of fewer blocks are flagged", ge=1
    )


class Measure(Block):
    share: Fraction = key(
        "T_trans under `stress`: the left front has covered this fraction of |x_minus|"
    )
    front_window: float = key(
        "last fraction of a path whose slope is the front speed", ge=0.05, lt=1.0
    )
    steady_tolerance: Fraction = key(
        "a largest velocity changing less over the last third is steady"
    )
    trailing_times: Distinct[Positive] = key("when the trailing edge is tabulated [H/c] (figure)")
    still: Fraction = key("slower than this fraction of the largest slip velocity is at rest")


class Sketch(Block):
    thickness: float = key("of the layer in the sketch [H]", ge=0.01, le=100.0)
    strip_width: float = key("of the integrated strip in the sketch [H]", ge=0.01, le=2.0)


class Steps(Block):
    from_: Ratio = key("the first", alias="from")
    to: Ratio = key("the last, above the first")
    count: int = key("how many", ge=2, le=10_000)

    @model_validator(mode="after")
    def _upwards(self) -> Self:
        require(self.to > self.from_, f"to: {self.to}", f"> from = {self.from_}")
        return self


class DamageZone(Block):
    stiffness_ratios: Steps = key("G/G_r")
    thickness_ratios: Distinct[Ratio] = key("H_r/H, one curve each")


class Figures(Block):
    fig01_system_sketch: Sketch = key("the sketch of the system")
    fig07_damage_zone: DamageZone = key("the damage zone")


class Claim(Block):
    tolerance: NonNegative | None = key("what counts as agreement, by kind", None)
    tolerance_exponent: Positive | None = key(
        "approximate claims: largest distance of exponent from 1", None
    )


class Reading(Block):
    simulation: str = key("name of the simulation whose run is compared with it")
    quantity: str = key("which of its measured numbers: a column of the measured table")
    statement: str = key("what was read off (figure)", min_length=1)
    value: float = key("the number (figure)")
    reading_error: Positive = key("of reading by pixel")
    arrow: bool = key(
        "whether it is a drawn arrow, which the best fit is found with and without", False
    )


class Configuration(Block):
    """The whole configuration."""

    preset: str = key("which of `presets` is used", words="the name of a preset")
    presets: dict[str, Preset] = key("trades of speed for accuracy, by name", min_length=1)
    accuracy: Annotated[float, Field(ge=1e-4, le=0.1)] | None = key(
        "largest relative numerical error of measured numbers, instead of a preset's spacing and step",
        None,
    )
    # As make and the command line may say it: yes, on, 1.
    allow_large: Annotated[bool, Field(strict=False)] = key(
        "whether simulations above the limits of cost run", False
    )
    model: Model = key("for every simulation that does not say otherwise")
    simulations: dict[Name, Simulation] = key("sweeps by name, each the product of its lists")
    scenes: dict[Name, NamedScene] = key("single runs by name", {})
    measure: Measure = key("how numbers are read off a run")
    figures: Figures = key("of figures that draw no simulation")
    claims: dict[str, Claim] = key(
        "other tolerances than those of manuscript/claims.yaml, by claim", {}
    )
    published: dict[str, Reading] = key("numbers read off a published figure, by name")
    studies: Distinct[Name] | None = key(
        "studies run for their tables; by default all", None, STUDIES
    )

    @model_validator(mode="after")
    def _names(self) -> Self:
        check_name("preset", self.preset, self.presets, ", ".join(self.presets))
        localised, scheme = "'localised' where accuracy is given", self.model.scheme
        require(
            self.accuracy is None or scheme == "localised", f"model.scheme: {scheme!r}", localised
        )
        for name in self.scenes:
            found = f"scenes.{name}: also the name of a simulation"
            require(name not in self.simulations, found, "another name")
            taken = name == "index" or name.removesuffix("_numbers") in {*self.scenes} - {name}
            found = f"scenes.{name}: another file of that name is there"
            require(not taken, found, "neither index nor SCENE_numbers")
        known = QUANTITIES | {
            f"trailing_edge_{time:g}": "fronts" for time in self.measure.trailing_times
        }
        for entry, reading in self.published.items():
            where, quantity, sweep = f"published.{entry}", reading.quantity, reading.simulation
            check_name(f"{where}.simulation", sweep, self.simulations, "a name under simulations")
            check_name(f"{where}.quantity", quantity, known, "a column of the measured table")
            needed, recorded = known[quantity], self.simulations[sweep].record
            allowed = f"what simulations.{sweep} records; this takes record: [fronts, {needed}]"
            require(needed in recorded, f"{where}.quantity: {short_repr(quantity)}", allowed)
        return self
