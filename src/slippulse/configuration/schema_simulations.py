"""Every key of a simulation and of a scene."""

from typing import Annotated, Literal

from pydantic import AfterValidator, StringConstraints
from pydantic_core import PydanticCustomError

from ..model.prestress import Prestress
from ..model.samples import RECORDS
from ..model.scene import BOUNDARIES, RELEASES, SCHEMES
from .keys import (
    LENGTH,
    STRESS,
    TIME,
    Allowed,
    Block,
    Count,
    NonNegative,
    NonNegatives,
    Number,
    Numbers,
    Positive,
    Positives,
    Spacing,
    choice,
    different,
    key,
    number,
    rows,
)

MODELS = "the model's"


def _not_zero(position: float) -> float:
    if position == 0.0:
        raise PydanticCustomError("zero", "zero")
    return position


class Profile(Block):
    """One pre-stress."""

    left: Number = key("level of the pre-stress far to the left", STRESS)
    right: Number = key("level far to the right", STRESS)
    width: Positive = key(
        "standard deviation W of the Gaussian at nucleation; at least the spacing",
        LENGTH,
        "paper",
        f"{Prestress.width:g}",
    )
    peak: Number = key(
        "value at x = 0; the pre-stress must reach 1 somewhere", STRESS, "paper", f"{Prestress.peak:g}"
    )
    steps: rows("position", "level") = key(
        "beyond each position, away from x = 0, its level holds", f"{LENGTH}, {STRESS}", otherwise="none"
    )
    bumps: rows("centre", "amplitude", "width") = key(
        "Gaussians that are added", f"{LENGTH}, {STRESS}, {LENGTH}", otherwise="none"
    )


class Beyond(Block):
    """Another level on one side, one run a level."""

    position: Annotated[Number, AfterValidator(_not_zero), Allowed("a number other than 0")] = key(
        "from here on, away from x = 0, the level is replaced", LENGTH
    )
    levels: Numbers = key("by each of these in turn", STRESS)


class Duration(Block):
    """How long a run is, in one of three units."""

    time: Positive = key("the duration itself", TIME, otherwise="another unit")
    half_periods: Positive = key(
        "in units of pi/sqrt(gamma), the paper's T_trans; under `displacement`", "", "ours", "another unit"
    )
    balance_distances: Positive = key(
        "in units of |x_minus|, where the pre-stress is balanced; right level 0, left level negative",
        "",
        "ours",
        "another unit",
    )


def _printable(title: str) -> str:
    if not title.isprintable() or title.isspace():
        raise PydanticCustomError("unprintable", "not a line")
    return title


def _with_fronts(record: list[str]) -> list[str]:
    if "fronts" not in record:
        raise PydanticCustomError("no_fronts", "no fronts")
    return record


def _one_unit(duration: Duration) -> Duration:
    if len(duration.model_fields_set) != 1:
        raise PydanticCustomError("one_unit", "not one unit")
    return duration


class SpacingRule(Block):
    """A rule for the block spacing: the preset's dx times scale W^width_power gamma^gamma_power, or a fixed one."""

    fixed: Spacing = key("the spacing itself, on the grid study's lattices too", LENGTH, otherwise="the rule")
    scale: Positive = key("factor of the preset's dx", otherwise="1")
    width_power: Number = key("power of W", otherwise="0")
    gamma_power: Number = key("power of gamma; under `displacement`", otherwise="0")


class Recording(Block):
    """Where and when slip and slip velocity are sampled."""

    times: number(at_least=2, at_most=100_000, whole=True) = key("how many, evenly over the duration")
    positions: number(at_least=1, at_most=100_000, whole=True) = key(
        "how many, evenly from -extent to extent; 1: at x = 0"
    )
    extent: NonNegative = key("how far to each side", LENGTH)


class Simulation(Block):
    """A sweep: the product of its lists."""

    boundary: choice(BOUNDARIES) = key(
        "condition at the top of the layer: displacement held (Gamma = 1) or stress held (Gamma = 0)",
        origin="paper",
    )
    left: Numbers = key(
        "levels of the pre-stress on the left, below 1", STRESS, "paper, lists ours", "`profiles`"
    )
    right: Annotated[
        Literal["same"] | Numbers, Allowed("'same', or a list of different numbers, at least one")
    ] = key("the same on the right; `same` mirrors the left", STRESS, "paper, lists ours", "`profiles`")
    width: Positives = key(
        "standard deviations W of the Gaussian at nucleation; at least the spacing",
        LENGTH,
        "paper, lists ours",
        f"[{Prestress.width:g}]",
    )
    profiles: different(Profile, "a list of different profiles, at least one") = key(
        "whole profiles, below, instead of the three above", otherwise="the three above"
    )
    beyond: Annotated[Beyond, Allowed("position and levels")] = key(
        "another level on one side, below", otherwise="none"
    )
    gamma: Positives = key(
        "elasticity ratio 2G/(lambda + 2G); required under `displacement`, left out under `stress`",
        "",
        "paper (near 2/3), lists ours",
        "none",
    )
    damping_ratio: NonNegatives = key("beta/dx", otherwise=MODELS)
    beta: NonNegatives = key("damping, instead of `damping_ratio`", LENGTH, otherwise="`damping_ratio`")
    duration: Annotated[
        Duration, AfterValidator(_one_unit), Allowed("one of time, half_periods, balance_distances")
    ] = key("how long each run is, in one of three units, below")
    spacing: Annotated[SpacingRule, Allowed("a mapping of fixed, or scale, width_power and gamma_power")] = (
        key("a rule for the block spacing, below", otherwise="the preset's dx")
    )
    dx: different(Spacing) = key("block spacings, instead of `spacing`", LENGTH, otherwise="`spacing`")
    release: Annotated[
        choice(RELEASES) | different(choice(RELEASES), "a list"),
        Allowed(f"{', '.join(RELEASES)}, or a list of both"),
    ] = key("whether the released stress includes the damping force, as under `model`", otherwise=MODELS)
    scheme: choice(SCHEMES) = key("as under `model`", otherwise=MODELS)
    friction_ratio: NonNegative = key("as under `model`", otherwise=MODELS)
    resolved_blocks: Count = key("as under `model`", "blocks", otherwise=MODELS)
    max_step: Positive = key(
        "largest step, within the stability bound", "dx", otherwise="the preset's, cut to the bound"
    )
    record: Annotated[
        different(choice(RECORDS), "a list of fronts (always: all is measured from them), fields, samples"),
        AfterValidator(_with_fronts),
    ] = key("what is kept: release and stick times; slip, velocity and acceleration at the end; samples")
    samples: Annotated[Recording, Allowed("a mapping of times, positions and extent")] = key(
        "what `record: [fronts, samples]` samples, below", otherwise="none"
    )
    chunks: number(at_least=1, at_most=1000, whole=True) = key(
        "how many jobs share the sweep, below; at most the number of runs", otherwise="1"
    )


class NamedScene(Profile):
    """One run by name."""

    title: Annotated[
        str,
        StringConstraints(min_length=1, max_length=120),
        AfterValidator(_printable),
        Allowed("one line of at most 120 printable characters, not blank"),
    ] = key("one line above figure and page")
    boundary: choice(BOUNDARIES) = key("as under `simulations`", origin="paper")
    gamma: Positive = key("as under `simulations`", "", "paper (near 2/3)", "none")
    damping_ratio: NonNegative = key("beta/dx", otherwise=MODELS)
    beta: NonNegative = key("damping, instead of `damping_ratio`", LENGTH, otherwise="`damping_ratio`")
    dx: Spacing = key("block spacing", LENGTH, otherwise="the preset's")
    release: choice(RELEASES) = key("as under `model`", otherwise=MODELS)
    scheme: choice(SCHEMES) = key("as under `model`", otherwise=MODELS)
    max_step: Positive = key("as under `simulations`", "dx", otherwise="the preset's, cut to the bound")
    resolved_blocks: Count = key("as under `model`", "blocks", otherwise=MODELS)
    duration: Positive = key("how long the run is", TIME)
