"""Every key of the studies of the solver: each has scenes of its own, see `slippulse.studies`."""

from ..model.scene import RELEASES
from .keys import (
    LENGTH,
    STRESS,
    TIME,
    Block,
    NonNegative,
    Order,
    Positive,
    Share,
    choice,
    different,
    key,
    number,
    row,
    rows,
)

# Wide around what is shipped, so that no study runs for ever or ends in an overflow.
Spacing = number(at_least=1e-4, at_most=1.0)
Time = number(at_least=0.01, at_most=1e6)
Length = number(at_least=1e-3, at_most=1e4)
Level = number(at_least=1e-3, at_most=0.99999)
Negative = number(at_least=-1e4, at_most=-1e-3)
Elasticity = number(at_least=1e-10, at_most=1e6)
Damping = number(at_least=0.0, at_most=1e4)
Ratio = number(at_least=1e-3, at_most=10.0)
Step = number(at_least=1e-3, at_most=10.0)
# Of the textbook scheme without damping or leaf springs, which is stable up to 1.
LockingStep = number(at_least=1e-3, at_most=1.0)
Multiple = number(at_least=0.01, at_most=100.0)
Size = number(at_least=50, at_most=10_000, whole=True)
SpacingList, StepList, Levels, Negatives, Elasticities, Dampings, Ratios, Orders = (
    different(kind) for kind in (Spacing, Step, Level, Negative, Elasticity, Damping, Ratio, Order)
)


class Range(Block):
    """Numbers in even steps."""

    from_: LockingStep = key("the first", "dx", alias="from")
    to: LockingStep = key("the last, above the first, within the stability bound", "dx")
    count: number(at_least=2, at_most=10_000, whole=True) = key("how many")


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

    levels: Levels = key("tau_0", STRESS)
    dx: Spacing = key("block spacing", LENGTH)
    duration: Time = key("of each run", TIME)


class LevelNearZero(Block):
    """Pre-stress that hardly drives a front."""

    width: Length = key("of the Gaussian, at least dx", LENGTH)
    level_dx_duration: rows(least=1, tau_0=Level, dx=Spacing, duration=Time) = key(
        "of each run", f"{STRESS}, {LENGTH}, {TIME}"
    )


class Gammas(Block):
    """Stiffness of the leaf springs."""

    small: Elasticities = key("each on a lattice of 500 blocks to 1/sqrt(gamma)")
    large: Elasticities = key("each at dx")
    dx: Spacing = key("block spacing of the large ones", LENGTH)


class DampingRatios(Block):
    """Damping under both release rules."""

    total: Dampings = key("beta/dx under the rule `total`")
    elastic: Dampings = key("beta/dx under the rule `elastic`")
    level: Level = key("tau_0", STRESS)
    dx: Spacing = key("block spacing", LENGTH)
    duration: Time = key("of each run", TIME)


class Spacings(Block):
    """Spacings up to the Burridge-Knopoff model."""

    pulse: SpacingList = key("block spacings of a pulse", LENGTH)
    duration: Time = key("of the pulse", TIME)
    transition: SpacingList = key("block spacings of a transition", LENGTH)


class Widths(Block):
    """Widths of the Gaussian."""

    blocks: different(number(at_least=0.01, at_most=1e3)) = key("W in blocks", "dx")
    wide: different(number(at_least=1.0, at_most=1e3)) = key("W in layer thicknesses", LENGTH)
    dx: Spacing = key("block spacing", LENGTH)
    duration: Time = key("of each run", TIME)


class NegativeLevel(Block):
    """A crack into negative pre-stress."""

    share: Share = key("of the path that is timed")
    level_dx_friction_ratio_damping: rows(
        least=1, tau_l=Negative, dx=Spacing, friction_ratio=NonNegative, damping_ratio=Damping
    ) = key("of each run", f"{STRESS}, {LENGTH}")


class LongRun(Block):
    """A pulse on dx = 1, for long."""

    duration: Time = key("of the run", TIME)
    gamma: Elasticity = key("elasticity ratio")


class SinglePrecision(Block):
    """The experiment in single precision."""

    dx: Spacing = key("block spacing", LENGTH)
    gamma: Elasticities = key("elasticity ratios")


class Peak(Block):
    """A peak beside the threshold."""

    apart: different(number(at_least=1e-15, at_most=0.5)) = key("how far from 1, below and above", STRESS)
    dx: Spacing = key("block spacing", LENGTH)
    duration: Time = key("of each run", TIME)


class TwoNucleations(Block):
    """Two nucleation points."""

    distance: Length = key("between them", LENGTH)
    dx: Spacing = key("block spacing", LENGTH)


Depths = different(number(at_least=1e-3, at_most=1e4))


class Barrier(Block):
    """A pulse into a barrier of low pre-stress."""

    dx: Spacing = key("block spacing", LENGTH)
    centre: Length = key("of the barrier", LENGTH)
    width: Length = key("of the barrier", LENGTH)
    deep: Depths = key("depths that must stop the pulse", STRESS)
    shallow: Depths = key("depths that must not", STRESS)
    duration: Time = key("of each run", TIME)


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

    damping_ratios: Dampings = key("beta/dx")
    between: row(lower=Multiple, upper=Multiple) = key("the bisection's ends, as shares of the derived bound")
    resolution: number(at_least=1e-6, at_most=0.1) = key("where the bisection ends")
    blocks: Size = key("size of the chain, or half of it")
    steps: Size = key("how long a mode may grow")


class Textbook(Block):
    """The textbook scheme beside the localised one."""

    dx: SpacingList = key("its block spacings", LENGTH)
    steps: StepList = key("its steps", "dx")


class Locking(Block):
    """Front speed of the textbook scheme against its step."""

    level: Level = key("tau_0", STRESS)
    dx: Spacing = key("block spacing", LENGTH)
    duration: Time = key("of each run", TIME)
    steps: Range = key("steps of the textbook scheme")
    every: number(at_least=1, at_most=10_000, whole=True) = key("the localised scheme at one step in so many")


class AccuracyCost(Block):
    """Error against cost."""

    level: Level = key("tau_0 of the pulse", STRESS)
    gamma: Elasticity = key("of the pulse")
    damping_ratios: Dampings = key("beta/dx; errors are the largest over them")
    duration: Time = key("of the pulse", TIME)
    dx: SpacingList = key("block spacings of the localised scheme", LENGTH)
    orders: Orders = key("its orders")
    steps: StepList = key("its steps, cut where they would not be stable", "dx")
    textbook: Textbook = key("the textbook scheme")
    negative_level: Negative = key("tau_l of the crack under held stress", STRESS)
    share: Share = key("of the crack's path that is timed")
    stress_duration: number(at_least=1.0, at_most=100.0) = key("of the crack, over that time")
    stress_scale: Multiple = key("its spacing over dx, within a spacing of 1")
    locking: Locking = key("front speed of the textbook scheme against its step")


class BarrierMap(Block):
    """Where exact depths are mapped."""

    levels: Levels = key("tau_0", STRESS)
    barriers: Negatives = key("tau_b", STRESS)


class Passing(Block):
    """Barriers shorter and longer than the exact depth."""

    shares: different(Multiple) = key("length of the barrier over the exact depth")
    dx: Spacing = key("block spacing", LENGTH)


class Barriers(Block):
    """Pulses sent into negative pre-stress, by exact theory and on lattices."""

    damping_ratios: Dampings = key("beta/dx, all for each pair of levels")
    levels: Levels = key("tau_0, where the pulse is steady", STRESS)
    barriers: Negatives = key("tau_b; every pair with a level", STRESS)
    gamma: Elasticities = key("elasticity ratios, one after the other over the pairs")
    dx: SpacingList = key("block spacings at which the depth is measured", LENGTH)
    map: BarrierMap = key("the map of exact depths")
    passing: Passing = key("both sides of passing")


class Notebook(Block):
    """Settings of the authors' public notebook."""

    damping_ratio: Ratio = key("beta/dx", origin="paper")
    dx: Spacing = key("block spacing", LENGTH, "paper")
    release: choice(RELEASES) = key("release rule", origin="paper")


class Arrows(Block):
    """Where the arrows of the published space-time figure end."""

    time: Time = key("T_trans, left panel", TIME, "figure")
    length: Length = key("L_trans, left panel", LENGTH, "figure")
    stress_time: Time = key("T_trans, right panel", TIME, "figure")


class RatiosByRule(Block):
    """Damping ratios under both release rules: enough for a cubic through them."""

    total: different(Ratio, least=4) = key("beta/dx under the rule `total`")
    elastic: different(Ratio, least=4) = key("beta/dx under the rule `elastic`")


class Near(Block):
    """Where the fits begin."""

    tau0: Level = key("pre-stress", STRESS, "figure")
    gamma: Elasticity = key("elasticity ratio", origin="figure")


class RightPanel(Block):
    """The right panel, whose largest velocity is compared."""

    left: Negative = key("tau_l", STRESS, "figure")
    width: number(at_least=1.0, at_most=1e4) = key("W", LENGTH, "figure")
    damping_ratios: Ratios = key("beta/dx at which it is run")
    duration: Time = key("in which the largest velocity is met", TIME)


class PublishedFigure(Block):
    """What the published space-time figure was made with."""

    beta: number(at_least=1e-6, at_most=10.0) = key(
        "damping of the figure, at most each damping ratio", origin="paper"
    )
    end: number(at_least=1.0, at_most=100.0) = key("of the left panel", TIME, "figure")
    near: Near = key("where the fits begin")
    damping_ratios: RatiosByRule = key("at each of which tau_0 and gamma are fitted")
    notebook: Notebook = key("settings of the authors' public notebook, fitted beside it")
    stress: RightPanel = key("the right panel")
    arrows: Arrows = key("drawn arrows, without a reading error: compared and not fitted")


class Requirements(Block):
    """Work a sliding block, bytes a block, and how the work grows."""

    level: Level = key("tau_0", STRESS)
    gamma: Elasticity = key("elasticity ratio")
    damping_ratio: Damping = key("beta/dx")
    durations: different(number(at_least=1.0, at_most=1e6), least=2) = key(
        "of the pulse whose work is fitted; the first in the fit over dx", TIME
    )
    dx: different(Spacing, least=2) = key("its block spacings; the first in the fit over durations", LENGTH)
    orders: Orders = key("whose bytes a block are counted")


class Studies(Block):
    """Studies of the solver itself."""

    extremes: Extremes = key("the edges of the solver's domain")
    stability: Stability = key("where a step blows up")
    accuracy_cost: AccuracyCost = key("error against cost")
    barriers: Barriers = key("how deep a pulse enters negative pre-stress")
    published_figure: PublishedFigure = key("what the published space-time figure was made with")
    requirements: Requirements = key("work and memory")
