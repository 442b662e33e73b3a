"""Claims about ruptures on lattices, in functions named as they are: equations, uniqueness and stability of pulses."""

from collections.abc import Mapping, Sequence
from itertools import chain, combinations
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..data.numerals import number
from ..measure.regime import REGIMES
from . import rules
from .evidence import Claim, Evidence, agreeing

TWO_WAY, STEADY = "pulses, two-way", "pulse, one-way, steady"
# A pulse a block wide has this many that slide at once.
ABOUT_ONE = 1.0
FRICTION = r"$\mu_k/(\mu_s-\mu_k)$"
CHANGE, HALF_WIDTH = "largest_velocity_change", "pulse_half_width"
# On which lattices the change of a pulse is told.
CHANGED = f"abs({CHANGE}) > uncertainty_{CHANGE}"
UNDAMPED = "damping_ratio == 0"
ALONE = {"steady_displacement": UNDAMPED}
# What is known to a block at either end of a pulse is judged where blocks are narrow.
NARROW = {"undamped_pulses": ""}
# Without leaf springs, and at the smallest gamma with them.
AT_ZERO = {"front_speed_undamped": "", "speed_against_gamma": "gamma == gamma.min()"}
# Pulses that meet another pre-stress, and come back from it or not; and those that began in each.
PERTURBED = ("pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere")
UNPERTURBED = ("any_prestress", "steady_displacement", "steady_elsewhere")
# Of each equation what is measured, what the paper has for it, and in which runs.
EQUATIONS: dict[str, tuple[str, str, dict[str, str]]] = {
    "front_speed": ("front_speed_right", "paper_front_speed_right", AT_ZERO),
    "pulse_profile": ("pulse_shape_deviation", "0", ALONE),
    **{id: (id, f"paper_{id}", ALONE) for id in ("pulse_peak_velocity", "pulse_slip")},
    **{id: (id, f"paper_{id}", NARROW) for id in ("pulse_width", "pulse_acceleration")},
    "stress_drop": ("pulse_stress_drop", "2 * left", ALONE),
    "energy_balance_at_zero": ("energy_change", "0", {"stress_pulses": UNDAMPED}),
}
# Distance from the exact line, relative, beyond which the regime of a lattice with another friction law is decided.
DECIDED = 0.08


class Always(NamedTuple):
    """What is to hold on a lattice in which runs of some sweeps: an expression, or one of some regimes at the end.

    With regimes the exact solution decides runs that are too short for a lattice to tell (``told``), and those on which
    lattices disagree. Besides the runs judged others are ``counted`` by regime; ``numbers`` are of the first sweep.
    """

    sweeps: str
    where: str
    holds: str = ""
    told: str = ""
    counted: Mapping[str, str] | None = None
    ends: Sequence[str] = ()
    numbers: Mapping[str, str] = {}


# A run tells of the transition if it lasts 1.5 of the paper's T_trans; under a stress boundary, 2.6 |x_minus|, as the
# collapses of figure 5 are run. Pulses that formed at level 0 meet another, `beyond` (`meet`); a small perturbation is
# within 0.03, in units of the friction drop.
ALWAYS = {
    "symmetric_displacement_pulses": Always(
        "regimes_displacement", "left > 0", told="duration > 1.5 * paper_transition_time", ends=[TWO_WAY]
    ),
    "one_way_pulse_displacement": Always(
        "regimes_displacement_asymmetric", "right > 0",
        ends=[regime for regime in REGIMES if regime.startswith("pulse, one-way")],
        counted={r"at $\tau_{0,r}=0$, without a verdict": "right == 0"},
    ),
    "symmetric_stress_cracks": Always("regimes_stress", "left == right > 0", ends=["crack-like, two-way"]),
    "one_way_pulse_stress": Always(
        "regimes_stress", "left < 0 and right == 0", told="duration >= 2.6 * exact_balance_distance",
        counted={r"at $\tau_{0,r}>0$, without a verdict": "left < 0 < right"}, ends=[STEADY],
    ),
    "stress_pulse_needs_barrier": Always(
        "regimes_stress", "(left < 0) == (right < 0)",
        ends=[regime for regime in REGIMES if regime not in (TWO_WAY, STEADY, "pulse, one-way, growing")],
    ),
    "steady_for_any_prestress": Always(
        "any_prestress steady_elsewhere", "0 < left < 1",
        f"slip_variation < {{tolerance}} and regime == {TWO_WAY!r}",
    ),
    "grows_above_zero": Always("regimes_beyond", "beyond > 0", "changed == 1 and widened == 1", CHANGED, {}),
    "decays_below_zero": Always("regimes_beyond", "beyond < 0", "changed == -1 and widened == -1", CHANGED, {}),
    "small_perturbation_changes_pulse": Always(
        "regimes_beyond", "0 < abs(beyond) <= 0.03", "changed * beyond > 0 and widened * beyond > 0", CHANGED,
        numbers={"smallest level": "abs(beyond).where(beyond != 0).min()"},
    ),
    "steady_only_at_zero": Always(
        "regimes_beyond", "",
        f"(beyond == 0 and abs({CHANGE}) <= {{steady}}) or (beyond != 0 and changed != 0)",
    ),
}  # fmt: skip


def always(evidence: Evidence, id: str) -> Claim:
    """A row of `ALWAYS`."""
    row, sweeps = ALWAYS[id], ALWAYS[id].sweeps.split()
    holds = row.holds.format(tolerance=evidence.tolerance(id), steady=evidence.steady)
    holds = holds or f"regime in {[*row.ends]}"
    decided = (evidence.agreed(sweep, row.where, holds, row.told, row.ends) for sweep in sweeps)
    counted = {} if row.counted is None else {"at the end": row.where, **row.counted}
    further = {
        words: float(evidence.tables[sweeps[0]].eval(each)) for words, each in row.numbers.items()
    }
    for words, where in counted.items():
        ends = evidence.lattices(*sweeps, where=where)[0]["regime"].value_counts()
        further |= {f"{words}: {regime}": float(count) for regime, count in ends.items()}
    return evidence.qualitative(chain.from_iterable(decided)) | {"further": further}


def meet(table: pd.DataFrame) -> dict[str, pd.Series]:
    """Whether the pulse of each run that meets another level grows (1), decays (-1) or neither, and widens, likewise.

    By more than in the run that began alike and meets level 0; one that is gone has decayed.
    """
    began = table[table["beyond"] == 0.0].set_index("left")
    change, still = table[CHANGE], table["left"].map(began[CHANGE])
    wider = table[HALF_WIDTH] - table["left"].map(began[HALF_WIDTH])
    signs = {
        "changed": np.sign(change).where(change.abs() > still.abs(), 0.0),
        "widened": np.sign(wider),
    }
    return {
        name: sign.mask(table["regime"] == "arrested", -1.0).fillna(0.0)
        for name, sign in signs.items()
    }


def shown(evidence: Evidence, held: dict[str, int], **further: float) -> Claim:
    """A claim that there are runs of each case: one of each suffices."""
    numbers = {name: float(value) for name, value in (held | further).items()}
    verdict = "reproduced" if all(held.values()) else "inconclusive"
    return evidence.qualitative([True] * sum(held.values())) | {
        "verdict": verdict,
        "further": numbers,
    }


def no_weakening_needed(evidence: Evidence, id: str) -> Claim:
    """There are steady pulses under both boundary conditions, and friction is one constant while sliding."""
    cases = {"displacement": ("any_prestress", TWO_WAY), "stress": ("stress_pulses", STEADY)}
    decided = {
        on: evidence.agreed(name, "", f"regime == {end!r}") for on, (name, end) in cases.items()
    }
    return shown(
        evidence, {f"with the {on} held": each.count(True) for on, each in decided.items()}
    )


def only_positive_velocities(evidence: Evidence, id: str) -> Claim:
    """No run of any simulation has a negative slip velocity; what friction must be for that."""
    finest = pd.concat([evidence.tables[name] for name in evidence.swept], ignore_index=True)
    needed, smallest = (
        float(finest["friction_ratio_needed"].max()),
        float(finest["min_velocity"].min()),
    )
    decided = finest["min_velocity"] >= -evidence.tolerance(id)
    back = int((finest["min_stuck_stress"] <= -1.0).sum())
    why = f"Blocks here cannot slide back; at the printed threshold, which has two sides, some would in {back} of"
    why += f" {len(finest)} runs. It needs {FRICTION} of at least {number(needed, 3)}."
    further = {f"{FRICTION} needed": needed, "smallest velocity": smallest}
    further["runs in which blocks would slide back at the printed threshold"] = float(back)
    claim = evidence.qualitative(decided, condition=needed > 0.0)
    return claim | {"further": further, "why": why if all(decided) and needed > 0.0 else ""}


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Claim:
    """There are pulses both ways with leaf springs, and a pulse one way without; and how many blocks wide they are."""
    chain, spike = (
        evidence.lattices(f"burridge_knopoff_{name}")[0] for name in ("chain", "stress")
    )
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    fewest, most = two_way.min(), two_way.max()
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    claim = shown(evidence, {"with leaf springs": len(two_way), "without": len(one_way)}, **further)
    if claim["verdict"] != "reproduced" or fewest <= ABOUT_ONE:
        return claim
    why = f"The two kinds of pulse are reproduced, their width is not: {number(fewest)} to {number(most)} blocks."
    return claim | {"verdict": "reproduced with caveat", "why": why}


def dimensional_peak_velocity(evidence: Evidence, id: str) -> Claim:
    """The printed dimensional peak velocity over U/T 1/sqrt(gamma), for a layer of rock; H and the strengths cancel."""
    modulus, shear_modulus, density = 9.0e10, 3.0e10, 2700.0
    slip, time = 2.0 / modulus, np.sqrt(density / modulus)
    derived = slip / time / np.sqrt(2.0 * shear_modulus / modulus)
    ratio = float(1.0 / np.sqrt(2.0 * shear_modulus * density) / derived)
    deviation = abs(ratio - 1.0)
    return {
        "verdict": rules.within(deviation, 0.0, evidence.tolerance(id)), "predicted": 1.0, "measured": ratio,
        "uncertainty": 8.0 * float(np.finfo(float).eps), "deviation": deviation,
    }  # fmt: skip


def equation(evidence: Evidence, id: str) -> Claim:
    """One equation, by the values of its runs at spacing 0."""
    quantity, paper, runs = EQUATIONS[id]
    tables = [evidence.lattices(name, where=where)[0] for name, where in runs.items()]
    return evidence.exact(id, pd.concat(tables), quantity, paper)


def front_speed_moderate_gamma(evidence: Evidence, id: str) -> Claim:
    """The front speed without damping for gamma up to 1."""
    where = f"{UNDAMPED} and 0.1 <= gamma <= 1"
    tables = evidence.lattices("speed_against_gamma", "steady_displacement", where=where)
    return evidence.approximate(id, tables, "front_speed_right", "paper_front_speed_right")


# With the displacement held


def displacement_pulse_unique(evidence: Evidence, id: str) -> Claim:
    """Pulses of one pre-stress from different beginnings are the same pulse."""
    table = evidence.lattices("nucleation_widths", "any_prestress", "steady_elsewhere", *PERTURBED)[
        0
    ]
    sizes = ["pulse_peak_velocity", "pulse_width", "pulse_slip"]
    groups = table.groupby(["beyond", "gamma", "damping_ratio"])
    found = [
        pair for _, rows in groups for pair in apart(rows, sizes, evidence.tolerance(id), False)
    ]
    return evidence.qualitative(
        [None if different is None else not different for different in found]
    )


def apart(table: pd.DataFrame, sizes: list[str], allowed: float, sure: bool) -> list[bool | None]:
    """Of each pair of runs whether a size differs by more than a tolerance; None where the uncertainty leaves it open.

    ``sure``: whether it takes the uncertainty too to say that none does.
    """
    blurs = table[[f"uncertainty_{size}" for size in sizes]].to_numpy()
    out: list[bool | None] = []
    for (one, blur), (other, more) in combinations(
        zip(table[sizes].to_numpy(), blurs, strict=True), 2
    ):
        off, unsure = np.abs(one / other - 1.0), (blur + more) / np.abs(other)
        equal = False if np.all(off + sure * unsure <= allowed) else None
        out.append(True if np.any(off - unsure > allowed) else equal)
    return out


def perturbed_pulses_settle(evidence: Evidence, id: str) -> Claim:
    """A pulse sent into another pre-stress leaves the slip of that pre-stress's own steady pulse."""
    keys, offs = ["left", "gamma", "damping_ratio"], []
    slips = {
        "slip off by at most": "pulse_slip",
        "slip off the exact slip by at most": "exact_pulse_slip",
        "slip off that without damping by at most": "paper_pulse_slip",
    }
    for table, own in zip(
        evidence.lattices(*PERTURBED), evidence.lattices(*UNPERTURBED), strict=True
    ):
        steady = own.drop_duplicates(keys).set_index(keys)[[*slips.values()]]
        there = steady.reindex(pd.MultiIndex.from_frame(table[["beyond", *keys[1:]]]))
        offs.append((table[["pulse_slip"]].to_numpy() / there - 1.0).abs())
    decided = agreeing(*(off["pulse_slip"] <= evidence.tolerance(id) for off in offs[:2]))
    further = {name: float(np.nanmax(offs[0][slip], initial=0.0)) for name, slip in slips.items()}
    return evidence.qualitative(decided) | {"further": further}


def damping_reduces_oscillations(evidence: Evidence, id: str) -> Claim:
    """Damping takes power from the waves of the lattice."""
    falls = []
    for table in evidence.lattices("steady_displacement")[:2]:
        by_level = table.sort_values("damping_ratio").groupby(["left", "gamma"])["lattice_noise"]
        falls.append(
            [after < before for _, noise in by_level for before, after in combinations(noise, 2)]
        )
    decided = agreeing(*falls)
    why = "It needs the sign opposite to the printed one." if all(decided) else ""
    return evidence.qualitative(decided, condition=True) | {"why": why}


# With the stress held


def zero_net_stress_change(evidence: Evidence, id: str) -> Claim:
    """No strain is left behind a pulse that keeps its shape; where some is left, the pulse changes."""
    where = f"beyond != 0 and strain_left > {evidence.tolerance(id)}"
    change = evidence.qualitative(evidence.agreed("regimes_beyond", where, "changed != 0"))
    claim = evidence.exact(
        id, evidence.lattices("stress_pulses", where=UNDAMPED)[0], "strain_left", "0"
    )
    return change | claim | {"verdict": rules.worst([claim["verdict"], change["verdict"]])}


def stress_pulse_not_unique(evidence: Evidence, id: str) -> Claim:
    """Different pre-stress makes different pulses in the same region of zero pre-stress."""
    table = evidence.lattices("stress_pulses", where="damping_ratio > 0")[0]
    # At the damping of the figures; without any, the lattice rings.
    table = table[table["damping_ratio"] == table["damping_ratio"].min()]
    sizes = ["pulse_peak_velocity", HALF_WIDTH]
    return evidence.qualitative(apart(table, sizes, evidence.tolerance(id), True))


def stress_pulse_set_by_prestress(evidence: Evidence, id: str) -> Claim:
    """Peak and half-width on the damped lattices are the functionals of the pre-stress that the exact solution has."""
    table, allowed = (
        evidence.lattices("stress_pulses", where="damping_ratio > 0")[0],
        evidence.tolerance(id),
    )
    exact = table[["exact_largest_velocity", "exact_half_width"]].to_numpy()
    off = (table[["pulse_peak_velocity", HALF_WIDTH]] / exact - 1.0).abs()
    sure = off - table[[f"uncertainty_{name}" for name in off]].to_numpy() / exact
    decided = agreeing((off <= allowed).all(axis=1), ~(sure > allowed).any(axis=1))
    most = "{} on the lattice, with damping, off by at most".format
    further = {
        most(name): float(size)
        for name, size in zip(("peak", "half-width"), off.max(), strict=True)
    }
    return evidence.qualitative(decided) | {"further": further}


# With other friction laws, as far as friction linear in slip rate tests it


def lattices_with_rate(evidence: Evidence) -> pd.DataFrame:
    """Runs with friction that depends on slip rate."""
    return evidence.tables["rate_dependence"].query("role == 'lattice'")


def pulses_for_many_friction_laws(evidence: Evidence, id: str) -> Claim:
    """At each pre-stress there are pulses with friction that weakens, and that strengthens, with slip rate."""
    runs = lattices_with_rate(evidence)
    depends = runs[runs["over_critical"] != 0.0]
    pulses = (
        (depends["regime"] == "pulse")
        .groupby([depends["level"], depends["over_critical"] > 0.0])
        .any()
    )
    limit = runs["rate_strengthening"] / runs["over_critical"] / runs["gamma"] ** 0.5
    where = "where they end, over the square root of gamma, at the {} pre-stress".format
    further = {where("lowest"): float(limit.min()), where("highest"): float(limit.max())}
    return evidence.qualitative(pulses, condition=True) | {"further": further}


def pulses_whatever_friction(evidence: Evidence, id: str) -> Claim:
    """The rupture is a pulse at every rate dependence; lattices next to the exact line decide nothing."""
    runs = lattices_with_rate(evidence)
    inside, pulse = runs["over_critical"].abs() < 1.0, runs["regime"] == "pulse"
    near = (runs["over_critical"].abs() - 1.0).abs() < DECIDED
    further = {
        "runs on the side of the exact line that it says": float((inside == pulse).sum()),
        "others, all next to the line": float((near & (inside != pulse)).sum()),
        "others, away from it": float((~near & (inside != pulse)).sum()),
    }
    decided = [None if close else held for close, held in zip(near, pulse, strict=True)]
    return evidence.qualitative(decided) | {"further": further}


def other_laws_change_pulses(evidence: Evidence, id: str) -> Claim:
    """Width and slip at the strongest dependences that still have pulses are not those without one."""
    runs = lattices_with_rate(evidence).set_index(["level", "over_critical"])[
        ["pulse_width", "pulse_slip"]
    ]
    of = {factor: runs.xs(factor, level=1) for factor in (-0.9, 0.0, 0.9)}
    change = pd.concat([(of[factor] / of[0.0] - 1.0).abs() for factor in (-0.9, 0.9)])
    held = (change > evidence.tolerance(id)).to_numpy().ravel()
    further = {
        f"smallest change of the {name[6:]}": float(least) for name, least in change.min().items()
    }
    return evidence.qualitative(held, condition=True) | {"further": further}
