"""Keys of a simulation and of a scene. Units in brackets, as in config/README.md."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from .keys import (
    Block,
    Boundary,
    Bump,
    Count,
    Distinct,
    NonNegative,
    Positive,
    Record,
    Release,
    Scheme,
    Spacing,
    Step,
    Title,
    allowed,
    require,
)

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
    dx: Spacing | None = Field(None, description="block spacing; by default the preset's [H]")
    release: Release | None = Field(None, description="by default the model's")
    duration: Positive = Field(description="how long the run is [H/c]")
