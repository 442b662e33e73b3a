"""Every key of the studies of the solver: each has scenes of its own, see `slippulse.studies`."""

from typing import Annotated

from pydantic import Field

from ..model.scene import RELEASES
from .keys import (
    LENGTH,
    STRESS,
    TIME,
    Allowed,
    Block,
    Count,
    NonNegative,
    NonNegatives,
    Order,
    Positive,
    Positives,
    Share,
    choice,
    different,
    key,
    number,
    rows,
)

Shares, Orders = different(Share), different(Order)
Negatives = different(number(below=0.0))
AtLeast50 = number(at_least=50, whole=True)


# Enough for a cubic through them.
FourOrMore = different(Positive, "a list of different numbers > 0, at least four", least=4)


class Range(Block):
    """Numbers in even steps."""

    from_: Positive = key("the first", "dx", alias="from")
    to: Positive = key("the last", "dx")
    count: number(at_least=2, whole=True) = key("how many")


class Tolerances(Block):
    """Largest deviation from exact theory: relative, absolute where 0 is expected."""

    front_speed: Positive = key("of the front speed")
    final_slip: Positive = key("of the slip behind a pulse")
    transition_time: Positive = key("of T_trans")
    share_time: Positive = key("of the time to cover a share of |x_minus|")
    speed_drift: Positive = key("change of a front speed over a long run")
    slip_drift: Positive = key("change of the final slip over a long run")
    energy_residual: Positive = key("of the energy balance")
    asymmetry: Positive = key("between the sides of a symmetric scene")


class LevelNearOne(Block):
    """Pre-stress close to the threshold."""

    levels: Shares = key("tau_0", STRESS)
    dx: Positive = key("block spacing", LENGTH)
    duration: Positive = key("of each run", TIME)


class LevelNearZero(Block):
    """Pre-stress that hardly drives a front."""

    width: Positive = key("of the Gaussian, at least dx", LENGTH)
    level_dx_duration: rows("tau_0", "dx", "duration", least=1) = key(
        "of each run", f"{STRESS}, {LENGTH}, {TIME}"
    )


class Gammas(Block):
    """Stiffness of the leaf springs."""

    small: Positives = key("each on a lattice of 500 blocks to 1/sqrt(gamma)")
    large: Positives = key("each at dx")
    dx: Positive = key("block spacing of the large ones", LENGTH)


class DampingRatios(Block):
    """Damping under both release rules."""

    total: NonNegatives = key("beta/dx under the rule `total`")
    elastic: NonNegatives = key("beta/dx under the rule `elastic`")
    level: Share = key("tau_0", STRESS)
    dx: Positive = key("block spacing", LENGTH)
    duration: Positive = key("of each run", TIME)


class Spacings(Block):
    """Spacings up to the Burridge-Knopoff model."""

    pulse: Positives = key("block spacings of a pulse", LENGTH)
    duration: Positive = key("of the pulse", TIME)
    transition: Positives = key("block spacings of a transition", LENGTH)


class Widths(Block):
    """Widths of the Gaussian."""

    blocks: Positives = key("W in blocks", "dx")
    wide: Positives = key("W in layer thicknesses", LENGTH)
    dx: Positive = key("block spacing", LENGTH)
    duration: Positive = key("of each run", TIME)


class NegativeLevel(Block):
    """A crack into negative pre-stress."""

    share: Share = key("of the path that is timed")
    level_dx_friction_ratio_damping: rows("tau_l", "dx", "friction_ratio", "damping_ratio", least=1) = key(
        "of each run", f"{STRESS}, {LENGTH}"
    )


class LongRun(Block):
    """A pulse on dx = 1, for long."""

    duration: Positive = key("of the run", TIME)
    gamma: Positive = key("elasticity ratio")


class SinglePrecision(Block):
    """The experiment in single precision."""

    dx: Positive = key("block spacing", LENGTH)
    gamma: Positives = key("elasticity ratios")


class Peak(Block):
    """A peak beside the threshold."""

    apart: Positives = key("how far from 1, below and above", STRESS)
    dx: Positive = key("block spacing", LENGTH)
    duration: Positive = key("of each run", TIME)


class TwoNucleations(Block):
    """Two nucleation points."""

    distance: Positive = key("between them", LENGTH)
    dx: Positive = key("block spacing", LENGTH)


class Barrier(Block):
    """A pulse into a barrier of low pre-stress."""

    dx: Positive = key("block spacing", LENGTH)
    centre: Positive = key("of the barrier", LENGTH)
    width: Positive = key("of the barrier", LENGTH)
    deep: Positives = key("depths that must stop the pulse", STRESS)
    shallow: Positives = key("depths that must not", STRESS)
    duration: Positive = key("of each run", TIME)


class Extremes(Block):
    """The edges of the solver's domain, each against exact theory."""

    tolerances: Tolerances = key(
        "largest deviations from exact theory: relative, absolute where 0 is expected"
    )
    level_near_one: LevelNearOne = key("pre-stress close to the threshold")
    level_near_zero: LevelNearZero = key("pre-stress that hardly drives a front")
    gamma: Gammas = key("stiffness of the leaf springs")
    damping_ratio: DampingRatios = key("damping")
    dx: Spacings = key("spacings up to the Burridge-Knopoff model")
    width: Widths = key("widths of the Gaussian")
    negative_level: NegativeLevel = key("cracks into negative pre-stress")
    long_run: LongRun = key("a pulse on dx = 1, for long")
    float32: SinglePrecision = key("the experiment in single precision")
    peak: Peak = key("a peak beside the threshold")
    two_nucleations: TwoNucleations = key("two nucleation points")
    barrier: Barrier = key("a pulse into a barrier")


class Stability(Block):
    """Where a step blows up."""

    damping_ratios: NonNegatives = key("beta/dx")
    between: Annotated[list[Positive], Field(min_length=2, max_length=2), Allowed("two numbers > 0")] = key(
        "the bisection's ends, as shares of the derived bound"
    )
    resolution: Positive = key("where the bisection ends")
    blocks: AtLeast50 = key("size of the chain, or half of it")
    steps: AtLeast50 = key("how long a mode may grow")


class Textbook(Block):
    """The textbook scheme beside the localised one."""

    dx: Positives = key("its block spacings", LENGTH)
    steps: Positives = key("its steps", "dx")


class Locking(Block):
    """Front speed of the textbook scheme against its step."""

    level: Share = key("tau_0", STRESS)
    dx: Positive = key("block spacing", LENGTH)
    duration: Positive = key("of each run", TIME)
    steps: Range = key("steps of the textbook scheme")
    every: Count = key("the localised scheme at one step in so many")


class AccuracyCost(Block):
    """Error against cost."""

    level: Share = key("tau_0 of the pulse", STRESS)
    gamma: Positive = key("of the pulse")
    damping_ratios: NonNegatives = key("beta/dx; errors are the largest over them")
    duration: Positive = key("of the pulse", TIME)
    dx: Positives = key("block spacings of the localised scheme", LENGTH)
    orders: Orders = key("its orders")
    steps: Positives = key("its steps, cut where they would not be stable", "dx")
    textbook: Textbook = key("the textbook scheme")
    negative_level: number(below=0.0) = key("tau_l of the crack under held stress", STRESS)
    share: Share = key("of the crack's path that is timed")
    stress_duration: Positive = key("of the crack, over that time")
    stress_scale: Positive = key("its spacing over dx")
    locking: Locking = key("front speed of the textbook scheme against its step")


class BarrierMap(Block):
    """Where exact depths are mapped."""

    levels: Shares = key("tau_0", STRESS)
    barriers: Negatives = key("tau_b", STRESS)


class Passing(Block):
    """Barriers shorter and longer than the exact depth."""

    shares: Positives = key("length of the barrier over the exact depth")
    dx: Positive = key("block spacing", LENGTH)


class Barriers(Block):
    """Pulses sent into negative pre-stress, by exact theory and on lattices."""

    damping_ratios: NonNegatives = key("beta/dx, all for each pair of levels")
    levels: Shares = key("tau_0, where the pulse is steady", STRESS)
    barriers: Negatives = key("tau_b; every pair with a level", STRESS)
    gamma: Positives = key("elasticity ratios, one after the other over the pairs")
    dx: Positives = key("block spacings at which the depth is measured", LENGTH)
    map: BarrierMap = key("the map of exact depths")
    passing: Passing = key("both sides of passing")


class Notebook(Block):
    """Settings of the authors' public notebook."""

    damping_ratio: Positive = key("beta/dx", origin="paper")
    dx: Positive = key("block spacing", LENGTH, "paper")
    release: choice(RELEASES) = key("release rule", origin="paper")


class Arrows(Block):
    """Where the arrows of the published space-time figure end."""

    time: Positive = key("T_trans, left panel", TIME, "figure")
    length: Positive = key("L_trans, left panel", LENGTH, "figure")
    stress_time: Positive = key("T_trans, right panel", TIME, "figure")


class RatiosByRule(Block):
    """Damping ratios under both release rules."""

    total: FourOrMore = key("beta/dx under the rule `total`")
    elastic: FourOrMore = key("beta/dx under the rule `elastic`")


class Near(Block):
    """Where the fits begin."""

    tau0: Share = key("pre-stress", STRESS, "figure")
    gamma: Positive = key("elasticity ratio", origin="figure")


class RightPanel(Block):
    """The right panel, whose largest velocity is compared."""

    left: number(below=0.0) = key("tau_l", STRESS, "figure")
    width: Positive = key("W", LENGTH, "figure")
    damping_ratios: Positives = key("beta/dx at which it is run")
    duration: Positive = key("in which the largest velocity is met", TIME)


class PublishedFigure(Block):
    """What the published space-time figure was made with."""

    beta: Positive = key("damping of the figure", origin="paper")
    end: Positive = key("of the left panel", TIME, "figure")
    near: Near = key("where the fits begin")
    damping_ratios: RatiosByRule = key("at each of which tau_0 and gamma are fitted")
    notebook: Notebook = key("settings of the authors' public notebook, fitted beside it")
    stress: RightPanel = key("the right panel")
    arrows: Arrows = key("drawn arrows, without a reading error: compared and not fitted")


class Requirements(Block):
    """Work a sliding block, bytes a block, and how the work grows."""

    level: Share = key("tau_0", STRESS)
    gamma: Positive = key("elasticity ratio")
    damping_ratio: NonNegative = key("beta/dx")
    durations: Positives = key("of the pulse whose work is fitted; the first in the fit over dx", TIME)
    dx: Positives = key("its block spacings; the first in the fit over durations", LENGTH)
    orders: Orders = key("whose bytes a block are counted")


class Studies(Block):
    """Studies of the solver itself."""

    extremes: Extremes = key("the edges of the solver's domain")
    stability: Stability = key("where a step blows up")
    accuracy_cost: AccuracyCost = key("error against cost")
    barriers: Barriers = key("how deep a pulse enters negative pre-stress")
    published_figure: PublishedFigure = key("what the published space-time figure was made with")
    requirements: Requirements = key("work and memory")
