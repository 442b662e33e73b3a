"""Every key of the configuration, once: type, unit, range, default, meaning, origin.

From these come the refusals (`refusals.schema_problems`), and through `python -m slippulse.configuration.describe` the
JSON Schema in workflow/schemas and the tables of config/README.md.
"""

from typing import Annotated

from pydantic import Field

from ..model.scene import RELEASES, SCHEMES
from .accuracy import LARGEST, SMALLEST
from .keys import (
    LENGTH,
    TIME,
    Allowed,
    Block,
    Count,
    Name,
    NonNegative,
    Number,
    Order,
    Positive,
    Positives,
    Sentence,
    Share,
    Spacing,
    Switch,
    choice,
    different,
    key,
    number,
)
from .schema_simulations import NamedScene, Simulation
from .schema_studies import Studies


class Preset(Block):
    """One trade of speed for accuracy."""

    dx: Spacing = key("block spacing where a simulation does not scale it", LENGTH)
    max_step: Positive = key(
        "largest time step; strong damping may need less, and releases and sticks lie within a step", "dx"
    )
    order: Order = key("order of the Taylor step")
    coarser: different(number(above=1.0), "two different factors > 1", 2, 2) = key(
        "factors of the spacing in the grid study behind every uncertainty"
    )
    whole: Switch = key(
        "whether studies, ledger and report are made by default; the target `everything` always makes them",
        otherwise="true",
    )


class Model(Block):
    """What holds for every simulation that does not say otherwise."""

    damping_ratio: NonNegative = key("beta/dx", "", "paper (beta = 1e-3), figure (dx = 0.01)")
    release: choice(RELEASES) = key(
        "whether the stress that is compared with the threshold includes the damping force (`total`) or not",
        "",
        "figure; the paper prints `elastic`",
    )
    scheme: choice(SCHEMES) = key(
        "`localised`: every release and stick at its instant; `fixed_step`: the textbook scheme; `continuum`: the exact"
        " solution of the continuum limit, to which `max_step` and `order` mean nothing"
    )
    friction_ratio: NonNegative = key(
        "mu_k/(mu_s - mu_k); a block would slide backwards at stress -(1 + 2 friction_ratio), and the run says so"
    )
    resolved_blocks: Count = key(
        "a pulse of fewer blocks (under a stress boundary: a Gaussian of fewer) is flagged as unresolved",
        "blocks",
    )


class Measure(Block):
    """How numbers are read off a run."""

    share: Share = key(
        "under a stress boundary T_trans is when the left front has covered this share of |x_minus|; the arrest"
        " itself never comes in the continuum"
    )
    front_window: number(at_least=0.05, below=1.0) = key(
        "a front speed is a straight line through this last share of its path"
    )
    steady_tolerance: Share = key(
        "a largest velocity that changes less than this over the last third is steady"
    )
    trailing_times: Positives = key("when the position of the trailing edge is tabulated", TIME, "figure")
    still: Share = key("slower than this share of the largest slip velocity counts as at rest")


class Sketch(Block):
    """The layer of figure 1."""

    thickness: number(at_least=0.01, at_most=100.0) = key("of the layer in the sketch", LENGTH)
    strip_width: number(at_least=0.01, at_most=2.0) = key("of the integrated strip in the sketch", LENGTH)


StiffnessRatio = number(at_least=1e-6, at_most=1e6)


class Steps(Block):
    """Numbers in steps of equal ratio."""

    from_: StiffnessRatio = key("the first", alias="from")
    to: StiffnessRatio = key("the last, above the first")
    count: number(at_least=2, at_most=10_000, whole=True) = key("how many")


class DamageZone(Block):
    """The curves of figure 7."""

    stiffness_ratios: Steps = key("G/G_r")
    thickness_ratios: different(number(at_least=1e-6, at_most=1e6)) = key("H_r/H, one curve each")


class Figures(Block):
    """Settings of figures that draw no simulation."""

    fig01_system_sketch: Sketch = key("the sketch of the system")
    fig07_damage_zone: DamageZone = key("the damage zone")


class Claim(Block):
    """When a claim counts as reproduced, in place of what stands with it in manuscript/claims.yaml."""

    tolerance: NonNegative = key("what counts as agreement, by kind", otherwise="as with the claim")
    tolerance_exponent: Positive = key(
        "of an approximate claim: largest distance of the exponent from 1", otherwise="as with the claim"
    )


class Reading(Block):
    """A number read off a published figure."""

    simulation: Annotated[str, Allowed("the name of a simulation")] = key("whose run stands beside it")
    quantity: Annotated[str, Allowed("a column of the measured table")] = key("which of its measured numbers")
    statement: Sentence = key("what was read off", origin="figure")
    value: Number = key("the number", origin="figure")
    reading_error: Positive = key("of reading by pixel")


class Configuration(Block):
    """The whole configuration."""

    preset: Annotated[str, Allowed("the name of a preset")] = key("which of `presets` is used")
    presets: Annotated[dict[str, Preset], Field(min_length=1)] = key("trades of speed for accuracy, by name")
    accuracy: number(at_least=SMALLEST, at_most=LARGEST) = key(
        "largest relative numerical error of measured numbers, instead of a preset's spacing and step",
        otherwise="none",
    )
    allow_large: Switch = key("whether simulations above the limits of cost run", otherwise="false")
    model: Model = key("for every simulation that does not say otherwise")
    simulations: dict[Name, Simulation] = key("sweeps by name, each the product of its lists")
    scenes: dict[Name, NamedScene] = key("single runs by name", otherwise="none")
    measure: Measure = key("how numbers are read off a run")
    figures: Figures = key("of figures that draw no simulation")
    claims: dict[str, Claim] = key("other tolerances than those of manuscript/claims.yaml, by claim")
    published: dict[str, Reading] = key("numbers read off a published figure, by name")
    studies: Studies = key("studies of the solver itself")
